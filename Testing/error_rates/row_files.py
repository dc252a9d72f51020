"""Files that keep simulated data sets, a row each, so that tables need not simulate them again."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable
from dataclasses import astuple, fields
from pathlib import Path
from typing import Any

TYPES: dict[str, Callable[[str], Any]] = {"str": str, "int": int, "float": float}


def stored_rows(path: Path, kind: type) -> list[Any]:
    """Return the rows of a file: objects of a dataclass of texts and numbers."""
    readers = {field.name: TYPES[str(field.type)] for field in fields(kind)}
    with path.open(encoding="utf-8", newline="") as file:
        return [
            kind(**{name: read(row[name]) for name, read in readers.items()})
            for row in csv.DictReader(file)
        ]


def play_missing(
    path: Path, kind: type, keys: Iterable[tuple], play: Callable[..., Any], names: int
) -> None:
    """Play what a file lacks, and add each row to it at once.

    Args:
        keys: The first `names` values of each row that the file should have.
        play: Returns the row of a key.
    """
    if not path.exists():
        header = ",".join(field.name for field in fields(kind))
        path.write_text(header + "\n", encoding="utf-8")
    known = {astuple(row)[:names] for row in stored_rows(path, kind)}
    for key in keys:
        if key not in known:
            with path.open("a", encoding="utf-8", newline="") as file:
                csv.writer(file, lineterminator="\n").writerow(astuple(play(*key)))
            print(*key, flush=True)
