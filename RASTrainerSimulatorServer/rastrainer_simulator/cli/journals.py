"""Commands that read journals of trials: `rastrainer verify` and `rastrainer measure`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from rastrainer.errors import InputError
from rastrainer.journal.journal_file import Integrity, JournalReading, read_journal
from rastrainer_simulator.cli.options import (
    JSON,
    Command,
    flag,
    json_text,
    option,
    path,
    study,
    text_table,
)

if TYPE_CHECKING:
    from rastrainer.study.database.study import Study


def verify(arguments: argparse.Namespace) -> int:
    if arguments.study is None:
        return max([_verify(path) for path in arguments.journals])
    from rastrainer.study.database.study import Study

    with Study.open_for_reading(arguments.study) as opened:
        return max([_verify(path, opened) for path in arguments.journals])


def _verify(path: Path, study: Study | None = None) -> int:
    try:
        reading = read_journal(path)
        problem = "" if study is None else _differs(reading, study)
    except InputError as error:
        print(f"rastrainer verify: {error}", file=sys.stderr)
        return 2
    print(f"{path}: {reading.sentence}{problem}")
    return 0 if reading.integrity is Integrity.INTACT and not problem else 1


def _differs(reading: JournalReading, study: Study) -> str:
    """Return how a journal is not the one that a study's trial came from; "" if it is."""
    try:
        record = study.trial(str(reading.header.get("trialId"))).record
    except InputError:
        return "; the study has no such finished trial"
    sealed = [entry["sha256"] for entry in reading.of_kind("registered")]
    if record.journal_sha256 in sealed:
        return ""
    return "; the trial in the study is not from this journal"


def measure(arguments: argparse.Namespace) -> int:
    # Only here: to verify a journal, no metric need be imported.
    from rastrainer.journal.recording import Recording
    from rastrainer.motion.trial_motion import trial_motion
    from rastrainer.study.outcomes import MOTION_METRICS

    reading = read_journal(arguments.journal)
    motion = trial_motion(Recording.of(reading.entries).trajectory())
    if arguments.json:
        print(json_text(motion))
        return 0
    known = [metric for name, metric in MOTION_METRICS.items() if name in motion]
    rows = [[d.title, f"{motion[d.name]:.4g}", d.unit] for d in known]
    print(f"{arguments.journal}: {reading.sentence}\n{text_table(['', 'value', 'unit'], rows)}")
    if arguments.explain:
        print("\n".join(f"\n{d.title}: {d.definition} Source: {d.source}." for d in known))
    return 0


COMMANDS = (
    Command(
        "verify",
        "check whether journals of trials are intact, cut short or altered",
        verify,
        (
            option("journals", nargs="+", type=Path, metavar="JOURNAL"),
            study("--study", "whose trials must be those of the journals; a file or an address"),
        ),
        "Exit status: 0 all intact (and those of the study's trials), 1 one cut short, altered or "
        "another, 2 one not a journal. Whether a trial was played as its journal says is found by "
        "`rastrainer replay --verify`.",
    ),
    Command(
        "measure",
        "compute the motion metrics of a trial from its journal",
        measure,
        (path("journal", "JOURNAL"), flag("--explain", "explain each metric"), JSON),
        "The numbers are those of the trial's record, to the last bit.",
    ),
)
