"""The planned lines of procedures as a table for a terminal."""

from __future__ import annotations

from collections.abc import Iterable

from rastrainer.number_text import fixed
from rastrainer.procedure.line_measures import LineMeasures
from rastrainer_simulator.authoring.procedure_plan import MeasuredProcedure

HEADER = (
    *("line", "length (mm)", "angle to the skull (°)", "nearest no-go structure (mm)"),
    *("nearest other line (mm)", "reach"),
)
REACH = {True: "yes", False: "no", None: "not tried"}


def line_table(procedures: Iterable[MeasuredProcedure]) -> list[str]:
    """Return the lines of a text: each procedure with its table, and what is wrong with it."""
    text = []
    for measured in procedures:
        rows = [HEADER]
        for line, is_held in zip(measured.lines, measured.is_held, strict=True):
            rows.append((*_cells(line), REACH[is_held]))
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        text.append(f"{measured.procedure.title} ({measured.procedure.name})")
        for row in rows:
            cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
            text.append("  ".join(cells).rstrip())
        text += [*measured.wrong, ""]
    return text[:-1] or ["The scenario has no procedure."]


def _cells(line: LineMeasures) -> tuple[str, str, str, str, str]:
    angle = line.skull_angle_deg
    near, other = line.nearest_no_go, line.nearest_line_mm
    return (
        line.name,
        fixed(line.length_mm, 1),
        "–" if angle is None else fixed(angle, 1),
        f"{fixed(line.no_go_mm[near], 1)} {near}" if near else "–",
        "–" if other is None else f"{fixed(other, 1)} {line.nearest_line}",
    )
