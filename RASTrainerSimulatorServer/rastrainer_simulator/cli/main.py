"""The command `rastrainer`: its parser, and which function adds each subcommand."""

from __future__ import annotations

import argparse
import pkgutil
import sys
from collections.abc import Sequence

import rastrainer
from rastrainer.errors import RASTrainerError

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
    "window": "rastrainer_simulator.cli.simulator:add_window_parser",
    "doctor": "rastrainer_simulator.cli.doctor_command:add_parser",
    "replay": "rastrainer_simulator.cli.replays:add_replay_parser",
    "rate": "rastrainer_simulator.cli.replays:add_rate_parser",
    "verify": "rastrainer_simulator.cli.journals:add_verify_parser",
    "simulate-cohort": "rastrainer_simulator.cli.cohort:add_parser",
    "demo": "rastrainer_simulator.cli.demo:add_parser",
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run one subcommand and return its exit status: 2 where the input cannot be used."""
    words = sys.argv[1:] if argv is None else list(argv)
    arguments = _parser(words).parse_args(words)
    try:
        return arguments.run(arguments)
    except RASTrainerError as error:
        print(f"rastrainer: {error}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        return 0
    except KeyboardInterrupt:
        return 130


def _parser(words: Sequence[str]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
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
