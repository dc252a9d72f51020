"""`rastrainer report STUDY -o DIR`: a study as a printable page."""

from __future__ import annotations

import argparse
from pathlib import Path

from rastrainer.report.report import write_report
from rastrainer_simulator.cli.options import (
    STUDY_HELP,
    add_incomplete,
    add_study,
    mean_times,
    read_known_study,
)

CSV_HEADER = "mode,subject,task,ct,rmse"


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the command to a command line; `arguments.run(arguments)` runs it."""
    parser = subparsers.add_parser(
        "report",
        help="write a study's report: tables, charts, tests, limits",
        description=(
            "Write report.html, which needs no other file and prints on A4, and trials.csv. "
            "Trainees who did not consent to research are left out."
        ),
    )
    add_study(parser, help_text=f"{STUDY_HELP}; or a CSV file with the header {CSV_HEADER}")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")
    parser.add_argument(
        "--mean-ct",
        action="append",
        default=[],
        metavar="[MODE=]SECONDS",
        help="a mean completion time for CTPS instead of the trials' own; see rastrainer score",
    )
    add_incomplete(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the report and return the exit status.

    Raises:
        InputError: the study cannot be read, or the folder not be written.
    """
    data = read_known_study(arguments)
    means = mean_times(arguments.mean_ct, list(data.modes))
    written = write_report(data.with_mean_times(means), arguments.output)
    aborted = f", {len(data.aborted)} aborted ones" if data.has_order else ""
    print(f"{written.page}: {len(data.trainees)} trainees, {len(data.trials)} trials{aborted}")
    return 0
