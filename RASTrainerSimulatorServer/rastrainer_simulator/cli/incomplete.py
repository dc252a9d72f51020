"""The option `--incomplete` of the commands that read a whole study."""

from __future__ import annotations

import argparse

from rastrainer.study.database.cohort_store import IncompleteStudyError
from rastrainer.study.study_data import StudyData, read_study_data


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
