"""`rastrainer doctor`: check everything that training needs, and suggest remedies."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from rastrainer.protocol import DEFAULT_PORT, DEFAULT_VIEW_PORT
from rastrainer_simulator.cli.options import add_records

if TYPE_CHECKING:
    from rastrainer_simulator.cli.doctor.check_result import CheckResult


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand to the parser of `rastrainer`."""
    parser = subparsers.add_parser(
        "doctor",
        help="check this computer, and suggest remedies for problems",
        description="Exit status: 0 without problems (warnings leave something out), 1 with one.",
    )
    parser.add_argument("--port", type=int, default=DEFAULT_PORT, help="of OpenIGTLink")
    parser.add_argument("--view-port", type=int, default=DEFAULT_VIEW_PORT, help="of the views")
    add_records(parser)
    parser.add_argument("--config", type=Path, metavar="DIR", help="of your settings")
    parser.add_argument("--json", action="store_true", help="print the findings as JSON")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print one line for each finding and return the exit status."""
    findings = _findings(arguments)
    if arguments.json:
        print(json.dumps([asdict(finding) for finding in findings], indent=2))
    else:
        print("\n".join(_lines(findings)))
    return 1 if any(finding.verdict == "problem" for finding in findings) else 0


def _findings(arguments: argparse.Namespace) -> list[CheckResult]:
    from rastrainer_simulator.cli.doctor.graphics import check_font, check_gamepad, check_graphics
    from rastrainer_simulator.cli.doctor.software import check_page, check_python, check_slicer
    from rastrainer_simulator.cli.doctor.system import (
        check_clock,
        check_folders,
        check_journals,
        check_ports,
        check_real_time,
        check_settings,
    )
    from rastrainer_simulator.ops.system_paths import config_folder, log_folder

    config = arguments.config
    folders = {
        "trials": arguments.records,
        "settings": config or config_folder(),
        "logs": config / "logs" if config else log_folder(),
    }
    findings = list(check_python())
    findings += check_graphics()
    findings += check_font()
    findings += check_gamepad()
    findings += check_ports(arguments.port, arguments.view_port)
    findings += check_page()
    findings += check_slicer()
    findings += check_real_time()
    findings += check_folders(folders)
    findings += check_settings(folders["settings"])
    findings += check_journals(arguments.records)
    findings += check_clock(arguments.records)
    return findings


def _lines(findings: Iterable[CheckResult]) -> Iterable[str]:
    for finding in findings:
        yield f"{finding.verdict.value:<8} {finding.check:<10} {finding.sentence}"
        if finding.remedy:
            yield f"{'':<19} → {finding.remedy}"
