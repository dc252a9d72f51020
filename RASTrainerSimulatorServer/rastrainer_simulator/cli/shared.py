"""What several commands share: tables for people, and reading studies that may be incomplete."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

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
