"""`rastrainer measure JOURNAL`: the motion metrics of a trial, from its journal."""

from __future__ import annotations

import argparse
from pathlib import Path

from rastrainer.journal.journal_file import read_journal
from rastrainer.journal.recording import Recording
from rastrainer.motion.definitions import DEFINITIONS
from rastrainer.motion.trial_motion import trial_motion
from rastrainer_simulator.cli.options import add_json, json_text, text_table


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the command to a command line; `arguments.run(arguments)` runs it."""
    parser = subparsers.add_parser(
        "measure",
        help="compute the motion metrics of a trial from its journal",
        description="The numbers are those of the trial's record, to the last bit.",
    )
    parser.add_argument("journal", type=Path, metavar="JOURNAL")
    parser.add_argument("--explain", action="store_true", help="explain each metric")
    add_json(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the metrics and return the exit status.

    Raises:
        InputError: the journal cannot be read.
    """
    reading = read_journal(arguments.journal)
    motion = trial_motion(Recording.of(reading.entries).trajectory())
    if arguments.json:
        print(json_text(motion))
        return 0
    known = [DEFINITIONS[name] for name in DEFINITIONS if name in motion]
    rows = [[d.title, f"{motion[d.name]:.4g}", d.unit] for d in known]
    print(f"{arguments.journal}: {reading.sentence}\n{text_table(['', 'value', 'unit'], rows)}")
    if arguments.explain:
        print("\n".join(f"\n{d.title}: {d.definition} Source: {d.source}." for d in known))
    return 0
