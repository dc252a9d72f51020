"""What a command is: its name, its arguments, its function; and what several commands share."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rastrainer.errors import InputError
from rastrainer.home_folder import home_folder
from rastrainer.study.database.database import EXAMPLE, StudyPlace, study_place

if TYPE_CHECKING:
    from rastrainer.study.study_data import StudyData

Argument = Callable[[Any], object]
"""Adds itself to a parser of argparse, or to a group of one."""


@dataclass(frozen=True)
class Command:
    """A command of `rastrainer`, or an action of one.

    Attributes:
        run: Returns the exit status; None where one of the `actions` is run.
        description: Above the arguments in the command's own help.
    """

    name: str
    help: str
    run: Callable[[argparse.Namespace], int] | None = None
    arguments: Sequence[Argument] = ()
    description: str | None = None
    actions: Sequence[Command] = ()

    def add_to(self, subparsers: argparse._SubParsersAction) -> None:
        parser = subparsers.add_parser(self.name, help=self.help, description=self.description)
        for add in self.arguments:
            add(parser)
        parser.set_defaults(run=self.run)
        if self.actions:
            of_actions = parser.add_subparsers(title="what to do", required=True, metavar="ACTION")
            for action in self.actions:
                action.add_to(of_actions)


def option(*names: str, **settings: Any) -> Argument:
    """Return an argument with the names and settings that argparse knows."""
    return lambda parser: parser.add_argument(*names, **settings)


def path(name: str, metavar: str, help_text: str | None = None, **settings: Any) -> Argument:
    return option(name, type=Path, metavar=metavar, help=help_text, **settings)


def output(help_text: str, **settings: Any) -> Argument:
    return option("-o", "--output", type=Path, metavar="DIR", help=help_text, **settings)


def number(name: str, default: float, help_text: str, **settings: Any) -> Argument:
    """Return an option with a number, which is of the type of its default."""
    return option(name, type=type(default), default=default, help=help_text, **settings)


def flag(name: str, help_text: str) -> Argument:
    return option(name, action="store_true", help=help_text)


def switch(name: str, help_text: str) -> Argument:
    """Return a flag that is set unless its opposite, `--no-…`, is given."""
    action = argparse.BooleanOptionalAction
    return option(name, action=action, default=True, help=help_text)


def group(title: str, *options: Argument) -> Argument:
    """Return options that the help shows below a title of their own."""

    def add(parser: argparse.ArgumentParser) -> None:
        added = parser.add_argument_group(title)
        for add_option in options:
            add_option(added)

    return add


def one_of(*options: Argument) -> Argument:
    """Return options of which at most one can be given."""

    def add(parser: argparse.ArgumentParser) -> None:
        added = parser.add_mutually_exclusive_group()
        for add_option in options:
            add_option(added)

    return add


def path_of_user(text: str) -> Path:
    """Return the path of an option, in which ~ is the home folder."""
    start, *rest = Path(text).parts or (".",)
    try:
        return home_folder().joinpath(*rest) if start == "~" else Path(text)
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _place(text: str) -> StudyPlace:
    try:
        return study_place(text)
    except InputError as error:
        # In place of argparse's own sentence, which would repeat what was entered.
        raise argparse.ArgumentTypeError(str(error)) from None


STUDY_HELP = f"a study's file, or its address in PostgreSQL, such as {EXAMPLE}"


def study(
    name: str = "study", help_text: str = STUDY_HELP, metavar: str = "STUDY", **settings: Any
) -> Argument:
    """Return the argument that says where a study is: a `StudyPlace`."""
    return option(name, type=_place, metavar=metavar, help=help_text, **settings)


CONFIG = path("--config", "DIR", "folder of your settings (default: the usual)")
RECORDS = option(
    "--records",
    type=path_of_user,
    metavar="DIR",
    default="~/RASTrainer/trials",
    help="folder of the trials' journals",
)
JSON = flag("--json", "print one JSON object")
INCOMPLETE = flag("--incomplete", "accept a virtual cohort that was not played to its end")


def check_ports(arguments: argparse.Namespace) -> None:
    """Raise `InputError` if a given `--port` or `--view-port` is invalid; 0 is any free one."""
    for name in ("port", "view_port"):
        port = getattr(arguments, name, None)
        if port is not None and not 0 <= port < 65536:
            raise InputError(f"--{name.replace('_', '-')} must be a number from 0 to 65535.")


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


def aligned(lines: Sequence[Sequence[str]], left: int) -> list[str]:
    """Return rows of cells as lines; `left` columns are aligned to the left, the others right."""
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    return [
        "  ".join(
            cell.ljust(width) if place < left else cell.rjust(width)
            for place, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]


def text_table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table with a line below its header; the first column is aligned to the left."""
    head, *others = aligned([header, *rows], 1)
    width = max(map(len, (head, *others)))
    return "\n".join([head, "-" * width, *others])
