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
    "register": "rastrainer.commands.register_command",
    "score": "rastrainer.commands.score_command",
    "measure": "rastrainer.commands.measure_command",
    "pass-mark": "rastrainer.commands.pass_mark_command",
    "report": "rastrainer.commands.report_command",
    "export": "rastrainer.commands.export_command",
    "delete-trainee": "rastrainer.commands.delete_command",
    "scenario": "rastrainer_simulator.scenario_command",
    "simulator": "rastrainer_simulator.simulator_command",
    "window": "rastrainer_simulator.window_command",
    "doctor": "rastrainer_simulator.doctor_command",
    "replay": "rastrainer_simulator.replay_command",
    "verify": "rastrainer_simulator.verify_command",
    "simulate-cohort": "rastrainer_simulator.cohort_command",
    "demo": "rastrainer_simulator.demo_command",
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
    asked = [word for word in words if word in SUBCOMMANDS][:1]
    for name in asked or SUBCOMMANDS:
        importlib.import_module(SUBCOMMANDS[name]).add_parser(subparsers)
    return parser


if __name__ == "__main__":
    sys.exit(main())
