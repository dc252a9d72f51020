"""Files that keep simulated data sets, a row each, so that tables need not simulate them again."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable
from dataclasses import astuple, fields
from pathlib import Path
from typing import Any

Floats = tuple[float, ...]
"""In a file with spaces between them."""
READERS: dict[str, Callable[[str], Any]] = {
    "str": str,
    "int": int,
    "float": float,
    "Floats": lambda text: tuple(map(float, text.split())),
}


def stored_rows(path: Path, kind: type) -> list[Any]:
    """Return the rows of a file: objects of a dataclass of texts and numbers."""
    readers = {field.name: READERS[str(field.type)] for field in fields(kind)}
    with path.open(encoding="utf-8", newline="") as file:
        return [
            kind(**{name: read(row[name]) for name, read in readers.items()})
            for row in csv.DictReader(file)
        ]


def add_row(path: Path, row: Any) -> None:
    """Add a row to a file, which is made if it is missing."""
    if not path.exists():
        header = ",".join(field.name for field in fields(row))
        path.write_text(header + "\n", encoding="utf-8")
    cells = [
        " ".join(f"{number:.10g}" for number in each) if isinstance(each, tuple) else each
        for each in astuple(row)
    ]
    with path.open("a", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerow(cells)


def play_missing(
    path: Path, kind: type, keys: Iterable[tuple], play: Callable[..., Any], names: int
) -> None:
    """Play what a file lacks, and add each row to it at once.

    A row's key are its first `names` values; `play` returns the row of a key.
    """
    known = {astuple(row)[:names] for row in stored_rows(path, kind)} if path.exists() else set()
    for key in keys:
        if key not in known:
            add_row(path, play(*key))
            print(*key, flush=True)
