"""What commands print: news and tables for people, and JSON for other programs."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any


def announce(program: str, what: str) -> None:
    """Print at once what a program of ours does, such as "board" and "is on http://…"."""
    print(f"RASTrainer {program} {what}", flush=True)


def json_text(value: Any) -> str:
    """Return a value as JSON; `ValueError` where a number is not finite."""
    return json.dumps(value, allow_nan=False, indent=1)


def text_table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return lines of aligned columns: the first to the left, the others to the right."""
    lines = [header, *rows]
    widths = [max(len(line[column]) for line in lines) for column in range(len(header))]
    aligned = [
        "  ".join(
            cell.rjust(width) if column else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]
    return "\n".join([aligned[0], "-" * (sum(widths) + 2 * len(widths) - 2), *aligned[1:]])
