"""`rastrainer delete-trainee STUDY PSEUDONYM`: one trainee, completely and for good."""

from __future__ import annotations

import argparse
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.study.database.study import Study
from rastrainer.study.trainee_data import erase_trainee
from rastrainer_simulator.cli.options import add_study


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the command to a command line; `arguments.run(arguments)` runs it."""
    parser = subparsers.add_parser(
        "delete-trainee",
        help="delete a trainee from a study and from the journals, for good",
        description=(
            "Nothing of the trainee is left in the database, the journals or later exports. "
            "Earlier exports, backups and printed reports are yours to delete. Exit status: 0 all "
            "is deleted, 1 journals may be left, 2 nothing was deleted."
        ),
    )
    add_study(parser)
    parser.add_argument("pseudonym", metavar="PSEUDONYM")
    parser.add_argument(
        "--records", type=Path, metavar="DIR", help="the folder of the simulator's journals"
    )
    parser.add_argument("--yes", action="store_true", help="really delete")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Delete the trainee and return the exit status.

    Raises:
        InputError: there is no such study or trainee, a journal cannot be deleted, or --yes or
            --records lacks.
    """
    with Study.open(arguments.study, must_exist=True) as study:
        count = len(study.history(arguments.pseudonym))
        if not arguments.yes:
            raise InputError(
                f"{arguments.pseudonym} has {count} trials, which would be lost for good; add "
                "--yes to delete them."
            )
        if arguments.records is None:
            raise InputError(
                f"The journals of {arguments.pseudonym} would be left; name the folder of the "
                "simulator's journals with --records (an empty one if there are none)."
            )
        erased = erase_trainee(study, arguments.pseudonym, arguments.records)
    print(f"{arguments.pseudonym}: {erased.trials} trials and {erased.journals} journals deleted")
    for sentence in erased.warnings:
        print(sentence)
    return 1 if erased.warnings else 0
