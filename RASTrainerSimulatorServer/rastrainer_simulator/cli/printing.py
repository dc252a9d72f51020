"""What several commands share: reading a study, and printing tables and JSON."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rastrainer.study.study_data import StudyData


def read_known_study(arguments: argparse.Namespace) -> StudyData:
    """Return the study of a command's arguments `study` and `incomplete`."""
    # Only here: most commands read no study, and need not wait for its import.
    from rastrainer.study.database.cohort_store import IncompleteStudyError
    from rastrainer.study.study_data import read_study_data

    try:
        return read_study_data(arguments.study, arguments.incomplete)
    except IncompleteStudyError as error:
        raise IncompleteStudyError(f"{error} --incomplete takes it as it is.") from None


def announce(program: str, what: str) -> None:
    """Print at once what one of our programs does, such as "board" and "is on http://…"."""
    print(f"RASTrainer {program} {what}", flush=True)


def json_text(value: Any) -> str:
    """Return a value as JSON, arrays and dataclasses, too; `ValueError` for an infinite number."""
    return json.dumps(
        value,
        allow_nan=False,
        indent=1,
        default=lambda one: one.tolist() if hasattr(one, "tolist") else asdict(one),
    )


def picked(value: object, *names: str) -> dict[str, Any]:
    return {name: getattr(value, name) for name in names}


def aligned(lines: Sequence[Sequence[str]], left: int) -> list[str]:
    """Return rows of cells as lines; `left` columns are aligned to the left, the others right."""
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    return [
        "  ".join(
            cell.ljust(width) if place < left else cell.rjust(width)
            for place, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]


def text_table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table with a line below its header; the first column is aligned to the left."""
    head, *others = aligned([header, *rows], 1)
    width = max(map(len, (head, *others)))
    return "\n".join([head, "-" * width, *others])
