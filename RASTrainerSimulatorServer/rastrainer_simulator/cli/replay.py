"""`rastrainer replay`: show a recorded trial, or simulate it again and compare."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from functools import partial
from pathlib import Path

from rastrainer_simulator.cli.options import add_playback, announce, check_ports


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand to the parser of `rastrainer`."""
    parser = subparsers.add_parser(
        "replay",
        help="show a recorded trial, or simulate it again and compare it bit by bit",
        description="Shows the trial in the window and to every view; Escape ends it. "
        "Exit status: 0 shown, or equal to the last bit; 1 something differs; 2 not replayable.",
    )
    parser.add_argument("journal", type=Path, metavar="JOURNAL")
    parser.add_argument(
        "--scenario", type=Path, metavar="DIR", help="the scenario it was recorded with"
    )
    parser.add_argument(
        "--verify",
        action="store_true",
        help="simulate the trial again and compare it with the journal instead of showing it",
    )
    parser.add_argument("--json", action="store_true", help="print the report of --verify as JSON")
    add_playback(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Show the trial, or print the result of the comparison, and return the exit status.

    Raises:
        InputError: the journal cannot be replayed, or an argument is not usable.
    """
    if not arguments.verify:
        return _show(arguments)
    # Only here: the robot and the scenario take time to import.
    from rastrainer.journal.journal_file import read_journal
    from rastrainer_simulator.record.recorded_setup import setup_of
    from rastrainer_simulator.replay.resimulation import replay

    reading = read_journal(arguments.journal)
    report = replay(reading, setup_of(reading.header, arguments.scenario))
    if arguments.json:
        whole = {**asdict(report), "identical": report.is_identical, "journal": reading.sentence}
        print(json.dumps(whole, indent=2, allow_nan=False))
    else:
        print(_summary(reading.sentence, report))
    return 0 if report.is_identical else 1


def _show(arguments: argparse.Namespace) -> int:
    check_ports(arguments)
    from rastrainer_simulator.server.replay_server import show

    playback = arguments.scenario, arguments.view_port, arguments.window
    show(arguments.journal, *playback, partial(announce, "replay"))
    return 0


def _summary(sentence: str, report) -> str:
    kinds = ", ".join(f"{count} {kind}" for kind, count in sorted(report.compared.items()))
    lines = [
        f"Trial {report.trial_id}",
        f"  journal    {sentence}",
        f"  replayed   {report.ticks} ticks; compared: {kinds}",
        f"  result     {report.difference or 'equal to the last bit'}",
    ]
    for name, (recorded, present) in report.changed_versions.items():
        lines.append(f"  version    {name}: recorded with {recorded}, replayed with {present}")
    for name, value in report.motion.items():
        lines.append(f"  {name:<24}{value:.6g}")
    return "\n".join(lines)
