"""`rastrainer curriculum STUDY`: what trainees are to reach, and where each of them stands."""

from __future__ import annotations

import argparse
from pathlib import Path

from rastrainer.number_text import fixed
from rastrainer.study.curriculum.curriculum import read_curriculum
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.curriculum.standing import (
    CurriculumStanding,
    advice_of,
    goal_of,
    short_progress_of,
    title_of,
)
from rastrainer.study.database.study import Study
from rastrainer_simulator.cli.options import add_study

HEADER = ("assignment", "trial", "so far", "goal", "after", "trials", "mean")


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the command to a command line; `arguments.run(arguments)` runs it."""
    parser = subparsers.add_parser(
        "curriculum",
        help="set the curriculum of a study's trainees, and print where they stand",
        description=(
            "Without an option, prints where each trainee stands. What is set last counts: a "
            "curriculum set for everybody ends those set for single trainees before. Nothing is "
            "overwritten; earlier trials count, too."
        ),
    )
    add_study(parser)
    choice = parser.add_mutually_exclusive_group()
    choice.add_argument(
        "--set", type=Path, metavar="FILE", help="a curriculum to follow from now on"
    )
    choice.add_argument("--end", action="store_true", help="follow no curriculum from now on")
    parser.add_argument("--trainee", metavar="PSEUDONYM", help="for this trainee alone")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Set the curriculum if asked to, print the tables, and return the exit status.

    Raises:
        InputError: there is no such study, trainee or curriculum.
    """
    curriculum = None if arguments.set is None else read_curriculum(arguments.set)
    who = arguments.trainee or ""
    if curriculum is not None or arguments.end:
        with Study.open(arguments.study, must_exist=True) as study:
            CurriculumStore(study).choose(curriculum, who)
        what = "no curriculum" if curriculum is None else f"“{curriculum.title}”"
        print(f"{who or 'Everybody'} follows {what} from now on.")
    with Study.open_for_reading(arguments.study) as study:
        store = CurriculumStore(study)
        standing = store.standing(who) if who else None
        found = {who: standing} if standing is not None else {} if who else store.standings()
    if not found and not arguments.end:
        print(f"{who or 'No trainee'} {'does not follow' if who else 'follows'} a curriculum.")
    for name, each in found.items():
        print(f"\n{_table(name, each)}")
    return 0


def _table(name: str, standing: CurriculumStanding) -> str:
    rows = [
        (
            each.assignment.name,
            title_of(each.assignment),
            short_progress_of(each),
            goal_of(each),
            ", ".join(each.assignment.after),
            str(each.played),
            "–" if each.mean is None else fixed(each.mean, 0),
        )
        for each in standing.standings
    ]
    widths = [max(map(len, column)) for column in zip(HEADER, *rows, strict=True)]
    lines = [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in (HEADER, *rows)
    ]
    reached = f"{standing.reached} of {len(standing.standings)} reached"
    title = f"{name}, {standing.curriculum.title}: {reached}. {advice_of(standing)}"
    return "\n".join((title, *lines))
