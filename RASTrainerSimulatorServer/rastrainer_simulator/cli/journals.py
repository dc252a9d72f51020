"""Commands that read journals of trials: `rastrainer verify` and `rastrainer measure`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer_simulator.cli.options import add_json, json_text, text_table


def add_verify_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add `verify`: is a trial's journal intact, cut short or altered?"""
    parser = subparsers.add_parser(
        "verify",
        help="check whether journals of trials are intact, cut short or altered",
        description="Exit status: 0 all intact, 1 one cut short or altered, 2 one not a journal.",
    )
    parser.add_argument("journals", nargs="+", type=Path, metavar="JOURNAL")
    parser.set_defaults(run=run_verify)


def run_verify(arguments: argparse.Namespace) -> int:
    """Print one line for each journal and return the exit status."""
    return max([_verify(path) for path in arguments.journals])


def _verify(path: Path) -> int:
    try:
        reading = read_journal(path)
    except InputError as error:
        print(f"rastrainer verify: {error}", file=sys.stderr)
        return 2
    print(f"{path}: {reading.sentence}")
    return 0 if reading.integrity is Integrity.INTACT else 1


def add_measure_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add `measure`: the motion metrics of a trial, from its journal."""
    parser = subparsers.add_parser(
        "measure",
        help="compute the motion metrics of a trial from its journal",
        description="The numbers are those of the trial's record, to the last bit.",
    )
    parser.add_argument("journal", type=Path, metavar="JOURNAL")
    parser.add_argument("--explain", action="store_true", help="explain each metric")
    add_json(parser)
    parser.set_defaults(run=run_measure)


def run_measure(arguments: argparse.Namespace) -> int:
    """Print the metrics and return the exit status.

    Raises:
        InputError: the journal cannot be read.
    """
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
