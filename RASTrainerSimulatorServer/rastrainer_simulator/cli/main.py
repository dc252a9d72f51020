"""The command `rastrainer`: its parser, and which function adds each subcommand."""

from __future__ import annotations

import argparse
import pkgutil
import sys
from collections.abc import Sequence
from typing import Any

import rastrainer
from rastrainer.errors import RASTrainerError
from rastrainer.files.reading import failure_reason, printable_name
from rastrainer.work_progress import allow_any_text

# By name, so that `rastrainer register` does not wait for the robot to be imported.
SUBCOMMANDS = {
    "register": "rastrainer_simulator.cli.register:add_parser",
    "compare-methods": "rastrainer_simulator.cli.compare_methods:add_parser",
    "score": "rastrainer_simulator.cli.results:add_score_parser",
    "measure": "rastrainer_simulator.cli.journals:add_measure_parser",
    "pass-mark": "rastrainer_simulator.cli.training_goals:add_pass_mark_parser",
    "curriculum": "rastrainer_simulator.cli.training_goals:add_curriculum_parser",
    "report": "rastrainer_simulator.cli.results:add_report_parser",
    "export": "rastrainer_simulator.cli.export:add_parser",
    "send-statements": "rastrainer_simulator.cli.send_statements:add_parser",
    "copy-study": "rastrainer_simulator.cli.study_management:add_copy_study_parser",
    "delete-trainee": "rastrainer_simulator.cli.study_management:add_delete_trainee_parser",
    "scenario": "rastrainer_simulator.cli.scenario:add_parser",
    "simulator": "rastrainer_simulator.cli.simulator:add_simulator_parser",
    "board": "rastrainer_simulator.cli.instructor:add_board_parser",
    "lti": "rastrainer_simulator.cli.lti:add_parser",
    "instructor-pin": "rastrainer_simulator.cli.instructor:add_instructor_pin_parser",
    "doctor": "rastrainer_simulator.cli.doctor_command:add_parser",
    "replay": "rastrainer_simulator.cli.replays:add_replay_parser",
    "rate": "rastrainer_simulator.cli.replays:add_rate_parser",
    "verify": "rastrainer_simulator.cli.journals:add_verify_parser",
    "simulate-cohort": "rastrainer_simulator.cli.cohort:add_parser",
    "demo": "rastrainer_simulator.cli.demo:add_parser",
}


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


def main(argv: Sequence[str] | None = None) -> int:
    """Run one subcommand and return its exit status: 2 where the input cannot be used."""
    allow_any_text()
    words = sys.argv[1:] if argv is None else list(argv)
    arguments = _parser(words).parse_args(words)
    try:
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
    named = [word for word in words if word in SUBCOMMANDS][:1]
    for name in named or SUBCOMMANDS:
        pkgutil.resolve_name(SUBCOMMANDS[name])(subparsers)
    return parser


if __name__ == "__main__":
    sys.exit(main())
