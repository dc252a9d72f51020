"""Arguments of commands, as each command lists them, and those that several share."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.home_folder import home_folder
from rastrainer.study.database.database import EXAMPLE, StudyPlace, study_place

Argument = Callable[[Any], object]
"""Adds itself to a parser of argparse, or to a group of one."""


def option(*names: str, **settings: Any) -> Argument:
    return lambda parser: parser.add_argument(*names, **settings)


def path(name: str, metavar: str, help_text: str | None = None, **settings: Any) -> Argument:
    return option(name, type=Path, metavar=metavar, help=help_text, **settings)


def output(help_text: str, **settings: Any) -> Argument:
    return option("-o", "--output", type=Path, metavar="DIR", help=help_text, **settings)


def number(
    name: str,
    default: float | None,
    help_text: str,
    least: float | None = None,
    most: float = math.inf,
    **settings: Any,
) -> Argument:
    """Return an option with a number, of the type of its default or of `least`, up to `most`."""
    kind = float if isinstance(default if least is None else least, float) else int

    def read(text: str) -> float:
        try:
            value = kind(text)
            is_right = least is None or least <= value <= most
        except (ValueError, OverflowError):
            is_right = False
        if not is_right:
            words = "a whole number" if kind is int else "a number"
            limits = "" if least is None else f" from {least}"
            limits += "" if math.isinf(most) else f" to {most}"
            raise argparse.ArgumentTypeError(f"must be {words}{limits}")
        return value

    return option(name, type=read, default=default, help=help_text, **settings)


def port(name: str, default: int | None, help_text: str) -> Argument:
    """Return an option with a port; 0 is any free one."""
    return number(name, default, help_text, 0, 65535, metavar="PORT")


def flag(name: str, help_text: str) -> Argument:
    return option(name, action="store_true", help=help_text)


def switch(name: str, help_text: str) -> Argument:
    """Return a flag that is set unless its opposite, `--no-…`, is given."""
    return option(name, action=argparse.BooleanOptionalAction, default=True, help=help_text)


def group(title: str, *options: Argument) -> Argument:
    """Return options that the help shows below a title."""
    return lambda parser: add_all(parser.add_argument_group(title), options)


def one_of(*options: Argument) -> Argument:
    """Return options of which at most one can be given."""
    return lambda parser: add_all(parser.add_mutually_exclusive_group(), options)


def add_all(parser: Any, arguments: Iterable[Argument]) -> None:
    for add in arguments:
        add(parser)


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
