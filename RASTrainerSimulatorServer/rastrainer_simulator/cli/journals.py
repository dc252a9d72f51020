"""Commands that read journals of trials: `rastrainer verify` and `rastrainer measure`."""

from __future__ import annotations

import argparse
import sys
from contextlib import nullcontext
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.journal.recording import Recording
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.study.database.study import Study
from rastrainer.study.outcomes import MOTION_METRICS
from rastrainer_simulator.cli.printing import json_text, text_table


def verify(arguments: argparse.Namespace) -> int:
    place = arguments.study
    with nullcontext() if place is None else Study.open_for_reading(place) as opened:
        return max([_verify(path, opened) for path in arguments.journal])


def _verify(path: Path, study: Study | None) -> int:
    problem = ""
    try:
        reading = read_journal(path)
        if study is not None:
            sealed = [entry["sha256"] for entry in reading.of_kind("registered")]
            try:
                record = study.trial(reading.header.trial_id).record
                if record.journal_sha256 not in sealed:
                    problem = "; the trial in the study is not from this journal"
            except InputError:
                problem = "; the study has no such finished trial"
    except InputError as error:
        print(f"rastrainer verify: {error}", file=sys.stderr)
        return 2
    print(f"{path}: {reading.sentence}{problem}")
    return 0 if reading.integrity is Integrity.INTACT and not problem else 1


def measure(arguments: argparse.Namespace) -> int:
    reading = read_journal(arguments.journal)
    motion = trial_motion(Recording.of(reading.lines()).trajectory())
    if arguments.json:
        print(json_text(motion))
        return 0
    known = [metric for name, metric in MOTION_METRICS.items() if name in motion]
    rows = [[d.title, f"{motion[d.name]:.4g}", d.unit] for d in known]
    print(f"{arguments.journal}: {reading.sentence}\n{text_table(['', 'value', 'unit'], rows)}")
    if arguments.explain:
        print("\n".join(f"\n{d.title}: {d.definition} Source: {d.source}." for d in known))
    return 0
