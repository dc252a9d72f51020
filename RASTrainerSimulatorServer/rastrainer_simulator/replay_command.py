"""`rastrainer replay`: play a trial again and prove that nothing differs."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand to the parser of `rastrainer`."""
    parser = subparsers.add_parser(
        "replay",
        help="simulate a recorded trial again and compare it bit by bit",
        description="Exit status: 0 equal to the last bit, 1 something differs, 2 not replayable.",
    )
    parser.add_argument("journal", type=Path, metavar="JOURNAL")
    parser.add_argument(
        "--scenario", type=Path, metavar="DIR", help="the scenario it was recorded with"
    )
    parser.add_argument("--json", action="store_true", help="print the report as JSON")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print what the replay has found and return the exit status."""
    # Only here: the robot and the scenario take time to import.
    from rastrainer.journal.journal_reader import read_journal
    from rastrainer_simulator.record.replay import replay, setup_of

    reading = read_journal(arguments.journal)
    report = replay(reading, setup_of(reading.header, arguments.scenario))
    if arguments.json:
        whole = {**asdict(report), "identical": report.is_identical, "journal": reading.sentence}
        print(json.dumps(whole, indent=2, allow_nan=False))
    else:
        print(_summary(reading.sentence, report))
    return 0 if report.is_identical else 1


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
    for name, value in asdict(report.metrics).items():
        lines.append(f"  {name:<22}{value:.6g}")
    return "\n".join(lines)
