"""What several commands share: options, the study they name, errors, and output."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rastrainer.errors import InputError
from rastrainer.home_folder import home_folder
from rastrainer.study.database.database import EXAMPLE, StudyPlace, study_place

if TYPE_CHECKING:
    from rastrainer.study.study_data import StudyData

DEFAULT_RECORDS = "~/RASTrainer/trials"
STUDY_HELP = f"a study's file, or its address in PostgreSQL, such as {EXAMPLE}"


def path_of_user(text: str) -> Path:
    """Return the path of an option, in which ~ is the home folder."""
    start, *rest = Path(text).parts or (".",)
    try:
        return home_folder().joinpath(*rest) if start == "~" else Path(text)
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def add_config(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--config", type=Path, metavar="DIR", help="folder of your settings (default: the usual)"
    )


def add_records(parser: argparse.ArgumentParser) -> None:
    """Add the folder of the trials' journals to a command's parser."""
    parser.add_argument(
        "--records",
        type=path_of_user,
        metavar="DIR",
        default=DEFAULT_RECORDS,
        help="folder of the trials' journals",
    )


def add_json(parser: argparse.ArgumentParser) -> None:
    """Add output for other programs to a command's parser."""
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def check_ports(arguments: argparse.Namespace) -> None:
    """Raise `InputError` if a given `--port` or `--view-port` is invalid; 0 is any free one."""
    for option in ("port", "view_port"):
        port = getattr(arguments, option, None)
        if port is not None and not 0 <= port < 65536:
            raise InputError(f"--{option.replace('_', '-')} must be a number from 0 to 65535.")


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
    """Return the study of a command's arguments `study` and `incomplete`."""
    # Only here: most commands read no study, and need not wait for its import.
    from rastrainer.study.database.cohort_store import IncompleteStudyError
    from rastrainer.study.study_data import read_study_data

    try:
        return read_study_data(arguments.study, arguments.incomplete)
    except IncompleteStudyError as error:
        raise IncompleteStudyError(f"{error} --incomplete takes it as it is.") from None


def announce(program: str, what: str) -> None:
    """Print at once what one of our programs does, such as "board" and "is on http://…"."""
    print(f"RASTrainer {program} {what}", flush=True)


def json_text(value: Any) -> str:
    """Return a value as JSON; `ValueError` where a number is not finite."""
    return json.dumps(value, allow_nan=False, indent=1)


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
