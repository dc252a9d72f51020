"""How the trials are distributed: each outcome by mode, every trial a dot, with the quartiles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rastrainer.report.charts.svg import FAINT, INK, Axis, Sheet, axis_over, mode_color, number
from rastrainer.report.html.markup import figure, section
from rastrainer.study.outcomes import MAIN_OUTCOMES, mode_title
from rastrainer.study.study_data import StudyData

WIDTH, LANE = 330, 74
LEFT, RIGHT = 66, 318
MOST_DOTS = 300
STACK = 38.0
"""Height of the highest stack of dots, px."""


def distributions(heading: str, lanes: Sequence[tuple[str, str, Sequence[float]]]) -> str:
    """Return the chart of lanes, each a name, a color and its values."""
    height = 54 + LANE * len(lanes)
    sheet = Sheet(WIDTH, height, f"Distribution of {heading}")
    sheet.text(10, 16, heading, 12.5, INK, weight="600")
    everything = [value for _, _, values in lanes for value in values]
    axis = axis_over(everything, LEFT, RIGHT)
    for tick in axis.ticks():
        x = axis.at(tick)
        sheet.line(x, 28, x, height - 24, "#e3e7ec")
        sheet.text(x, height - 10, number(tick), 10, FAINT, "middle")
    for index, (name, color, values) in enumerate(lanes):
        y = 32 + LANE * (index + 0.5)
        sheet.text(LEFT - 10, y + 4, name.split(" ")[0], 11, INK, "end")
        _lane(sheet, axis, y, color, values)
    return sheet.svg()


def _lane(sheet: Sheet, axis: Axis, y: float, color: str, values: Sequence[float]) -> None:
    ordered = np.sort(np.asarray(values, dtype=float))
    shown = ordered
    if len(ordered) > MOST_DOTS:
        shown = np.quantile(ordered, np.linspace(0, 1, MOST_DOTS))
    radius = 3.2 if len(shown) <= 60 else 1.8
    for x, row in _swarm(np.array([axis.at(value) for value in shown]), 2 * radius):
        sheet.dot(x, y + 2 - row, radius, color, 0.75)
    low, middle, high = (axis.at(q) for q in np.quantile(ordered, [0.25, 0.5, 0.75]))
    sheet.rect(low, y + 10, high - low, 8, color, 0.35)
    sheet.line(middle, y + 7, middle, y + 21, color, 2.5)
    sheet.line(axis.at(ordered[0]), y + 14, low, y + 14, color, 1.2)
    sheet.line(high, y + 14, axis.at(ordered[-1]), y + 14, color, 1.2)


def _swarm(xs: np.ndarray, size: float) -> list[tuple[float, float]]:
    """Return positions of dots that are stacked where they would hide each other.

    Stacks that would be too high are pressed together, all alike, so that their shape remains.
    """
    placed: list[tuple[float, float]] = []
    for x in xs:
        row = 0.0
        while any(abs(x - ox) < size and abs(row - orow) < 0.9 * size for ox, orow in placed):
            row += size
        placed.append((float(x), row))
    highest = max((row for _, row in placed), default=0.0)
    share = min(1.0, STACK / highest) if highest else 1.0
    return [(x, share * row) for x, row in placed]


def spread(data: StudyData) -> str:
    """Return a chart an outcome, each with a lane a mode."""
    charts = []
    for outcome in MAIN_OUTCOMES:
        lanes = []
        for index, mode in enumerate(data.modes):
            values = [
                t.values[outcome.name] for t in data.of_mode(mode) if outcome.name in t.values
            ]
            if values:
                lanes.append((mode_title(mode), mode_color(mode, index), values))
        if lanes:
            charts.append(distributions(outcome.heading, lanes))
    caption = "All trials; below the dots the middle half, the median, and the whole range."
    return section("Distributions", figure(charts, caption))
