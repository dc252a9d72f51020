"""`rastrainer verify`: is a trial's journal intact, cut short or altered?"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.journal.journal_file import Integrity, read_journal


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand to the parser of `rastrainer`."""
    parser = subparsers.add_parser(
        "verify",
        help="check whether journals of trials are intact, cut short or altered",
        description="Exit status: 0 all intact, 1 one cut short or altered, 2 one not a journal.",
    )
    parser.add_argument("journals", nargs="+", type=Path, metavar="JOURNAL")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print one line for each journal and return the exit status."""
    statuses = [_verify(path) for path in arguments.journals]
    return max(statuses)


def _verify(path: Path) -> int:
    try:
        reading = read_journal(path)
    except InputError as error:
        print(f"rastrainer verify: {error}", file=sys.stderr)
        return 2
    print(f"{path}: {reading.sentence}")
    return 0 if reading.integrity is Integrity.INTACT else 1
