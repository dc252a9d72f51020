"""What several commands share: tables for people, where a study is, and reading studies."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from rastrainer.errors import InputError
from rastrainer.study.database.address import EXAMPLE, StudyPlace, study_place
from rastrainer.study.database.cohort_store import IncompleteStudyError
from rastrainer.study.study_data import StudyData, read_study_data


def text_table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return lines of aligned columns: the first to the left, the others to the right."""
    lines = [header, *rows]
    widths = [max(len(line[column]) for line in lines) for column in range(len(header))]
    aligned = [
        "  ".join(
            cell.rjust(width) if column else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]
    return "\n".join([aligned[0], "-" * (sum(widths) + 2 * len(widths) - 2), *aligned[1:]])


STUDY_HELP = f"a study's file, or its address in PostgreSQL, such as {EXAMPLE}"


def add_study(
    parser: argparse.ArgumentParser,
    name: str = "study",
    metavar: str = "STUDY",
    help_text: str = STUDY_HELP,
    nargs: str | None = None,
) -> None:
    """Add where a study is to a command's parser: a `StudyPlace`."""
    parser.add_argument(name, type=_place, metavar=metavar, help=help_text, nargs=nargs)


def _place(text: str) -> StudyPlace:
    try:
        return study_place(text)
    except InputError as error:
        # In place of argparse's own sentence, which would repeat what was entered.
        raise argparse.ArgumentTypeError(str(error)) from None


def add_incomplete(parser: argparse.ArgumentParser) -> None:
    """Add the option to a command's parser."""
    parser.add_argument(
        "--incomplete",
        action="store_true",
        help="accept a virtual cohort that was not played to its end",
    )


def read_known_study(arguments: argparse.Namespace) -> StudyData:
    """Return the study of a command's arguments `study` and `incomplete`.

    Raises:
        InputError: the study cannot be read, or is incomplete and the option is not given.
    """
    try:
        return read_study_data(arguments.study, arguments.incomplete)
    except IncompleteStudyError as error:
        raise IncompleteStudyError(f"{error} --incomplete takes it as it is.") from None
