"""`rastrainer demo`: a virtual trainee, the simulator and Slicer's side play two trials."""

from __future__ import annotations

import argparse
from pathlib import Path


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand to the parser of `rastrainer`."""
    parser = subparsers.add_parser(
        "demo", help="play two trials with a virtual trainee and show the results"
    )
    parser.add_argument("--output", type=Path, default=Path("rastrainer-demo"), metavar="DIR")
    parser.add_argument("--seed", type=int, default=2026, help="of the trainee and the head's pose")
    parser.add_argument(
        "--speed", type=float, default=10.0, help="simulated seconds a second (default: 10)"
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Play the demo and return the exit status."""
    from rastrainer_simulator.demo import play_demo

    play_demo(arguments.output, arguments.seed, arguments.speed)
    return 0
