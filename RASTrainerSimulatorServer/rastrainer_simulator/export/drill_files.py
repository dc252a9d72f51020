"""Drills of decisions as behavioral data of a BIDS dataset: a table for each drill."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rastrainer.decision.case_table import COLUMNS, cells
from rastrainer.decision.drill_record import DrillRecord
from rastrainer.decision.drill_rows import drill_rows
from rastrainer.files.writing import make_folder, write_json, write_text
from rastrainer.protocol import DECIDE


def write_drills(drills: Sequence[DrillRecord], labels: Mapping[str, str], folder: Path) -> None:
    """Write a table for each drill, and the description of their columns at the top."""
    for drill, row in zip(drills, drill_rows(drills), strict=True):
        subject = f"sub-{labels[drill.trainee]}"
        name = f"{subject}_task-{DECIDE}_acq-{drill.mode}_run-{row.number:02d}_beh.tsv"
        make_folder(folder / subject / "beh")
        found = [["n/a" if cell is None else str(cell) for cell in cells(c)] for c in drill.cases]
        write_text(folder / subject / "beh" / name, tsv([list(COLUMNS), *found]))
    if drills:
        write_json(folder / f"task-{DECIDE}_beh.json", _DESCRIPTION)


def tsv(rows: Sequence[Sequence[str]]) -> str:
    """Return rows as text; a cell has no white space but spaces, and is never empty."""
    return "".join("\t".join(" ".join(c.split()) or "n/a" for c in row) + "\n" for row in rows)


_DESCRIPTION: dict[str, Any] = {
    "TaskName": DECIDE,
    "TaskDescription": "In each case, a virtual operator has registered a head to its images, with "
    "a fault or without. The trainee checks places on the head, and proceeds, registers again or "
    "stops.",
    **{
        name: {"Description": description} | ({"Units": units} if units else {})
        for name, (description, units) in COLUMNS.items()
    },
}
