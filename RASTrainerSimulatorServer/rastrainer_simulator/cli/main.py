"""The command `rastrainer`: one parser, one subcommand a file."""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Sequence

import rastrainer
from rastrainer.errors import RASTrainerError

# By module, so that `rastrainer register` does not wait for the robot to be imported.
SUBCOMMANDS = {
    "register": "rastrainer_simulator.cli.register",
    "compare-methods": "rastrainer_simulator.cli.compare_methods",
    "score": "rastrainer_simulator.cli.score",
    "measure": "rastrainer_simulator.cli.measure",
    "pass-mark": "rastrainer_simulator.cli.pass_mark",
    "curriculum": "rastrainer_simulator.cli.curriculum",
    "report": "rastrainer_simulator.cli.report",
    "export": "rastrainer_simulator.cli.export",
    "send-statements": "rastrainer_simulator.cli.send_statements",
    "copy-study": "rastrainer_simulator.cli.copy_study",
    "delete-trainee": "rastrainer_simulator.cli.delete",
    "scenario": "rastrainer_simulator.cli.scenario",
    "simulator": "rastrainer_simulator.cli.simulator",
    "board": "rastrainer_simulator.cli.board",
    "lti": "rastrainer_simulator.cli.lti",
    "instructor-pin": "rastrainer_simulator.cli.instructor_pin",
    "window": "rastrainer_simulator.cli.window",
    "doctor": "rastrainer_simulator.cli.doctor_command",
    "replay": "rastrainer_simulator.cli.replay",
    "rate": "rastrainer_simulator.cli.rate",
    "verify": "rastrainer_simulator.cli.verify",
    "simulate-cohort": "rastrainer_simulator.cli.cohort",
    "demo": "rastrainer_simulator.cli.demo",
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
        importlib.import_module(SUBCOMMANDS[name]).add_parser(subparsers)
    return parser


if __name__ == "__main__":
    sys.exit(main())
