"""The command `rastrainer`: its parser is made from `commands.txt`, which has every command."""

from __future__ import annotations

import argparse
import gc
import math
import re
import sys
from collections.abc import Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

import rastrainer
from rastrainer.errors import InputError, RASTrainerError
from rastrainer.files.reading import failure_reason, printable_name
from rastrainer.home_folder import home_folder
from rastrainer.work_progress import allow_any_text


class CliCommand(NamedTuple):
    """A command as `commands.txt` describes it; `run` is its module and function."""

    run: str
    help: str
    description: str
    arguments: list[str]


def read_commands() -> dict[str, CliCommand]:
    """Return every command by its name, such as `scenario build`."""
    text = Path(__file__).with_name("commands.txt").read_text(encoding="utf-8")
    shared: dict[str, list[str]] = {}
    commands = {}
    for block in re.split(r"\n(?=[a-z@])", text)[1:]:
        title, _, rest = block.partition("\n")
        name, _, run = title.partition(" = ")
        # A line that is indented farther continues the line before it.
        paragraphs = re.sub(r"\n {4,}", " ", rest).strip().split("\n\n")
        arguments = []
        if run or name.startswith("@"):
            for line in map(str.strip, paragraphs.pop().splitlines()):
                arguments += shared.get(line, [line])
        if name.startswith("@"):
            shared[name] = arguments
        else:
            words, description = (" ".join(each.split()) for each in (*paragraphs, "")[:2])
            commands[name] = CliCommand(run, words, description, arguments)
    return commands


PATHS = (
    *("DIR", "DRAFT", "FILE", "FILE.webm", "HEAD.ply", "JOURNAL", "JSON", "MRK_JSON", "PNG"),
    *("PROTOCOL", "TRIALS.csv", "VOLUME", "ZIP"),
)
STUDIES = ("STUDY", "FROM", "TO")
"""Names of values in `commands.txt` that are not text."""


def _read(name: str, limits: str, text: str) -> object:
    """Return a value: a number if it has limits, such as `0..65535`; else a path, or a study."""
    if not limits:
        try:
            start, *rest = Path(text).parts or (".",)
            if name in STUDIES:
                # Only here: its import takes longer than all others of this module.
                from rastrainer.study.database.database import study_place

                return study_place(text)
            return home_folder().joinpath(*rest) if start == "~" else Path(text)
        except InputError as error:
            # Argparse's own sentence would repeat the text that was entered.
            raise argparse.ArgumentTypeError(str(error)) from None
    least, is_range, most = limits.partition("..")
    kind = float if limits == "float" or "." in least else int
    try:
        value = kind(text)
        if not is_range or kind(least) <= value <= (kind(most) if most else math.inf):
            return value
    except (ValueError, OverflowError):
        pass
    words = "a whole number" if kind is int else "a number"
    words += f" from {least}" if is_range else ""
    words += f" to {most}" if most else ""
    raise argparse.ArgumentTypeError(f"must be {words}")


ARGUMENT = re.compile(
    r"(?P<names>(?:-\w, )?--\S+)? ?(?P<values>.*?)(?:\((?P<limits>.+)\))?(?P<more>\.\.\.)?"
    r"(?P<mark> [*!])?(?: = (?P<default>.+))?"
)
MARKS: dict[str, dict[str, Any]] = {
    " *": {"action": "append", "default": []},
    " !": {"required": True},
}


def _add_argument(parser: Any, line: str) -> None:
    """Add an argument, such as `-o, --output DIR = build  folder to write into`, to a parser."""
    signature, _, words = line.partition("  ")
    found = ARGUMENT.fullmatch(signature)
    assert found is not None, line
    names, values = (found["names"] or "").split(", "), found["values"].split()
    default = found["default"]
    if default and "default" not in words:
        words += f" (default: {default})"
    settings: dict[str, Any] = {"help": words.replace("%", "%%") or None}
    if "[no-]" in names[0]:
        names = [names[0].replace("[no-]", "")]
        settings |= {"action": argparse.BooleanOptionalAction, "default": True}
    elif not values:
        settings["action"] = "store_true"
    elif values[0].startswith("{"):
        settings["choices"] = values[0].strip("{}").split(",")
    else:
        is_optional = values[0] == f"[{values[0][1:-1]}]"
        values = [values[0][1:-1]] if is_optional else values
        settings["metavar"] = tuple(values) if len(values) > 1 else values[0]
        if len(values) > 1:
            settings["nargs"] = len(values)
        elif is_optional or found["more"]:
            settings["nargs"] = "?" if is_optional else "+"
        if found["limits"] or values[0] in (*PATHS, *STUDIES):
            settings["type"] = partial(_read, values[0], found["limits"] or "")
    if default:
        several = len(values) > 1
        settings["default"] = tuple(map(float, default.split())) if several else default
    settings |= MARKS.get(found["mark"], {})
    if not names[0]:
        names = [re.split(r"\W", values[0])[0].lower()]
    parser.add_argument(*names, **settings)


class _CommandParser(argparse.ArgumentParser):
    """The parser of `rastrainer`, and of each command and its subcommands."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message.rstrip('.')}; see {self.prog} --help.")


def command_parser() -> argparse.ArgumentParser:
    """Return the parser of all commands; its namespace has the command's `run`."""
    parser = _CommandParser(
        prog="rastrainer",
        description="Trainer for robot-assisted, image-guided neurosurgery. Not for clinical use.",
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {rastrainer.__version__}")
    below = {"": parser.add_subparsers(title="commands", required=True, metavar="COMMAND")}
    for whole_name, command in read_commands().items():
        parent, _, name = whole_name.rpartition(" ")
        of_command = below[parent].add_parser(
            name, help=command.help, description=command.description or None
        )
        if not command.run:
            below[name] = of_command.add_subparsers(
                title="what to do", required=True, metavar="ACTION"
            )
        of_command.set_defaults(run=command.run)
        group: Any = of_command
        for line in command.arguments:
            if line.endswith(":"):
                group = of_command.add_argument_group(line.removesuffix(":"))
            else:
                _add_argument(group, line)
    return parser


def run_command(words: Sequence[str]) -> int:
    """Run one command and return its exit status; only its module is imported."""
    arguments = command_parser().parse_args(words)
    module, _, function = arguments.run.partition(".")
    return getattr(import_module(f"rastrainer_simulator.cli.{module}"), function)(arguments)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status: 2 where the input cannot be used."""
    allow_any_text()
    # Modules stay: looking for garbage among them would be a twentieth of the simulator's start.
    gc.set_threshold(100_000)
    try:
        return run_command(sys.argv[1:] if argv is None else list(argv))
    except RASTrainerError as error:
        print(f"rastrainer: {error}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        return 0
    except OSError as error:
        if error.filename is None:
            raise
        name, reason = printable_name(error.filename), failure_reason(error)
        print(f"rastrainer: {name} cannot be used: {reason}.", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
