"""`rastrainer copy-study FROM TO`: a study from a file into PostgreSQL, or back."""

from __future__ import annotations

import argparse

from rastrainer.errors import InputError
from rastrainer.number_text import counted
from rastrainer.study.database.companions import beside_study
from rastrainer.study.database.copying import copy_study
from rastrainer.study.database.study import Study
from rastrainer.study.platform_links import PlatformLinks
from rastrainer_simulator.cli.shared import add_study


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the command to a command line; `arguments.run(arguments)` runs it."""
    parser = subparsers.add_parser(
        "copy-study",
        help="copy a study from its file into PostgreSQL, or back",
        description=(
            "Copy all trainees, trials, results and ratings, compare them with the original to the "
            "last bit, and leave the original as it is. Nobody should train meanwhile: what comes "
            "later is not copied."
        ),
    )
    add_study(parser, "source", "FROM", "the study: a file, or an address of PostgreSQL")
    add_study(parser, "target", "TO", "an empty database of PostgreSQL, or a file to be made")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Copy, say how much, and return the exit status.

    Raises:
        InputError: a study cannot be used, or TO holds something.
    """
    if str(arguments.source) == str(arguments.target):
        raise InputError("FROM and TO are the same study.")
    with Study.open_for_reading(arguments.source) as source, Study.open(arguments.target) as target:
        counts = copy_study(source, target)
        links = PlatformLinks(beside_study(source.database.place))
        users = links.copy_to(PlatformLinks(beside_study(target.database.place)))
    print(
        f"{arguments.target}: {counted(counts['trainees'], 'trainee')}, "
        f"{counted(counts['trials'], 'trial')}, {counted(sum(counts.values()), 'row')} in all, "
        "each compared with its original"
    )
    if users:
        print(f"{counted(users, 'user')} of learning platforms copied with it")
    return 0
