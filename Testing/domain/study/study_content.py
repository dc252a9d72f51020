"""All content of a study, and all files written from it, to compare two copies of it."""

from __future__ import annotations

import csv
import io
import re
from pathlib import Path

from rastrainer.study.database.database import StudyPlace
from rastrainer.study.database.schema import TABLES
from rastrainer.study.database.study import Study
from rastrainer_simulator.cli.main import main

_MADE = re.compile(rb"\d{4}-\d\d-\d\d \d\d:\d\d UTC")
"""When a report was made."""


def rows_of(place: StudyPlace) -> dict[str, list[tuple]]:
    """Return all rows by table, in the order of storing."""
    with Study.open_for_reading(place) as study:
        return {
            table.name: study.database.rows(
                f"SELECT {', '.join(table.columns)} FROM {table.name} ORDER BY {table.order}"
            )
            for table in TABLES.values()
        }


def table_of(text: str) -> list[dict[str, str]]:
    """Return the rows of CSV text, by the names of its columns."""
    return list(csv.DictReader(io.StringIO(text)))


def written_files(place: StudyPlace, folder: Path) -> dict[str, bytes]:
    """Return all files of report and exports by name, except for the time when they were made."""
    assert main(["report", str(place), "-o", str(folder / "report")]) == 0
    assert main(["export", str(place), "-o", str(folder / "export")]) == 0
    files = [path for path in folder.rglob("*") if path.is_file()]
    return {str(path.relative_to(folder)): _MADE.sub(b"", path.read_bytes()) for path in files}
