"""The option by which commands find the folder of the trials' journals."""

from __future__ import annotations

import argparse
from pathlib import Path

DEFAULT_RECORDS = Path.home() / "RASTrainer" / "trials"


def add_records(parser: argparse.ArgumentParser) -> None:
    """Add the option to a command's parser."""
    parser.add_argument(
        "--records",
        type=Path,
        metavar="DIR",
        default=DEFAULT_RECORDS,
        help="folder of the trials' journals (default: %(default)s)",
    )
