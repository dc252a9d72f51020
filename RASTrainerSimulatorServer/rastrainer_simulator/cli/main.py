"""The command `rastrainer`: its parser, and where each command is."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Any, NoReturn

import rastrainer
from rastrainer.errors import InputError, RASTrainerError
from rastrainer.files.reading import failure_reason, printable_name
from rastrainer.work_progress import allow_any_text

MODULES = {
    "register": "rastrainer_simulator.cli.register",
    "compare-methods": "rastrainer_simulator.cli.compare_methods",
    "score": "rastrainer_simulator.cli.results",
    "measure": "rastrainer_simulator.cli.journals",
    "pass-mark": "rastrainer_simulator.cli.training_goals",
    "curriculum": "rastrainer_simulator.cli.training_goals",
    "report": "rastrainer_simulator.cli.results",
    "export": "rastrainer_simulator.cli.export",
    "copy-study": "rastrainer_simulator.cli.study_management",
    "delete-trainee": "rastrainer_simulator.cli.study_management",
    "scenario": "rastrainer_simulator.cli.scenario",
    "simulator": "rastrainer_simulator.cli.simulator",
    "board": "rastrainer_simulator.cli.instructor",
    "instructor-pin": "rastrainer_simulator.cli.instructor",
    "doctor": "rastrainer_simulator.cli.doctor",
    "replay": "rastrainer_simulator.cli.replays",
    "rate": "rastrainer_simulator.cli.replays",
    "verify": "rastrainer_simulator.cli.journals",
    "simulate-cohort": "rastrainer_simulator.cli.cohort",
    "demo": "rastrainer_simulator.cli.demo",
}
"""Which module has each command among its `COMMANDS`. Only that one is imported, so that
`rastrainer register` does not wait for the robot."""


class _HelpWithDefaults(argparse.HelpFormatter):
    """Adds its default to the help of each option that has one, unless the help names it."""

    def _get_help_string(self, action: argparse.Action) -> str:
        text, default = action.help or "", action.default
        has_words = default in (None, argparse.SUPPRESS) or isinstance(default, (bool, list))
        if has_words or not action.option_strings or "default" in text:
            return text
        values = default if isinstance(default, tuple) else (default,)
        numbers = (f"{value:g}" if isinstance(value, float) else str(value) for value in values)
        shown = " ".join(numbers).replace("%", "%%")
        return f"{text} (default: {shown})"


class _CommandParser(argparse.ArgumentParser):
    """The parser of `rastrainer`, and of each command and its subcommands."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(formatter_class=_HelpWithDefaults, **settings)

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message.rstrip('.')}; see {self.prog} --help.")


def main(argv: Sequence[str] | None = None) -> int:
    """Run one subcommand and return its exit status: 2 where the input cannot be used."""
    allow_any_text()
    words = sys.argv[1:] if argv is None else list(argv)
    try:
        arguments = _parser(words).parse_args(words)
        return arguments.run(arguments)
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


def _parser(words: Sequence[str]) -> argparse.ArgumentParser:
    parser = _CommandParser(
        prog="rastrainer",
        description="Trainer for robot-assisted, image-guided neurosurgery. Not for clinical use.",
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {rastrainer.__version__}")
    subparsers = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")
    for name in [word for word in words if word in MODULES][:1] or MODULES:
        module = import_module(MODULES[name])
        next(each for each in module.COMMANDS if each.name == name).add_to(subparsers)
    return parser


if __name__ == "__main__":
    sys.exit(main())
