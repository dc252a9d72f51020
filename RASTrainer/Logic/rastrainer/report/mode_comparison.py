"""The modes side by side: by task (the paper's Fig. 8), as distributions, and by motion metric."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.number_text import fixed
from rastrainer.report import page, svg
from rastrainer.report.comparisons import ModeComparison, tested
from rastrainer.report.paired_statistics import interval_text
from rastrainer.study.outcomes import (
    MAIN_OUTCOMES,
    MOTION_OUTCOMES,
    Outcome,
    mode_title,
    short_mode_title,
    task_title,
)
from rastrainer.study.study_data import StudyData, values_of

SHOWN = ("completion_time_s", "rmse_mm", "ctps", "score")


def mode_comparison(data: StudyData) -> str:
    """Return one chart per outcome, with the modes side by side for every task."""
    charts = [
        _chart(data, outcome)
        for outcome in MAIN_OUTCOMES
        if outcome.name in SHOWN and any(outcome.name in trial.values for trial in data.trials)
    ]
    parts = [page.figure([chart], "") for chart in charts[:-1]]
    last = page.figure(
        charts[-1:], "Modes compared task by task, as in the paper's Fig. 8, with every trial."
    )
    return page.section("The modes, task by task", *parts, last)


def _chart(data: StudyData, outcome: Outcome) -> str:
    series = [
        Series(
            mode_title(mode),
            svg.mode_color(mode, index),
            tuple(
                tuple(values_of((t for t in data.of_mode(mode) if t.task == task), outcome.name))
                for task in data.tasks
            ),
        )
        for index, mode in enumerate(data.modes)
    ]
    return grouped_bars(outcome.heading, [task_title(task) for task in data.tasks], series)


WIDTH, HEIGHT = 680, 222
LEFT, RIGHT, TOP, BOTTOM = 48, 672, 42, 186
MAX_DOTS = 40


@dataclass(frozen=True)
class Series:
    """One color: name and values of each group."""

    name: str
    color: str
    values: tuple[tuple[float, ...], ...]


def grouped_bars(
    heading: str, groups: Sequence[str], series: Sequence[Series], by: str = "task and mode"
) -> str:
    """Return the chart; bars are means, whiskers one standard deviation (n − 1)."""
    sheet = svg.Sheet(WIDTH, HEIGHT, heading, f"{heading} by {by}", LEFT - 34)
    svg.legend(sheet, LEFT, 34, [(one.name, one.color) for one in series])
    everything = [value for one in series for values in one.values for value in values]
    axis = svg.axis_over(everything, BOTTOM, TOP + 6, from_zero=True)
    svg.y_grid(sheet, axis, LEFT, RIGHT)
    slot = (RIGHT - LEFT) / len(groups)
    width = min(46.0, slot * 0.72 / len(series))
    for column, group in enumerate(groups):
        center = LEFT + slot * (column + 0.5)
        for index, one in enumerate(series):
            x = center + (index - (len(series) - 1) / 2) * width
            if one.values[column]:
                _bar(sheet, axis, x, width * 0.88, one.color, one.values[column])
        sheet.text(center, HEIGHT - 18, group, 11, svg.INK, "middle")
    sheet.text(LEFT, HEIGHT - 3, "bar: mean; whisker: ± 1 SD; dot: one trial", 9.5, svg.FAINT)
    return sheet.svg()


def _bar(
    sheet: svg.Sheet, axis, x: float, width: float, color: str, values: Sequence[float]
) -> None:
    mean = float(np.mean(values))
    zero, top = axis.at(0.0), axis.at(mean)
    sheet.rect(x - width / 2, min(zero, top), width, abs(zero - top), color, 0.32)
    sheet.line(x - width / 2, top, x + width / 2, top, color, 2.2)
    if len(values) > 1:
        sd = float(np.std(values, ddof=1))
        sheet.line(x, axis.at(mean - sd), x, axis.at(mean + sd), color, 1.2)
    shown = values if len(values) <= MAX_DOTS else np.quantile(values, np.linspace(0, 1, MAX_DOTS))
    for index, value in enumerate(shown):
        spread = ((index * 0.618) % 1.0 - 0.5) * width * 0.55
        sheet.dot(x + spread, axis.at(value), 2.4, color, 0.9)


LANE_WIDTH, LANE_HEIGHT = 330, 74
LANE_LEFT, LANE_RIGHT = 66, 318
MAX_LANE_DOTS = 300
STACK = 38.0
"""Height of the highest stack of dots, px."""


def distribution_chart(heading: str, lanes: Sequence[tuple[str, str, Sequence[float]]]) -> str:
    """Return the chart of lanes with name, color and values."""
    height = 54 + LANE_HEIGHT * len(lanes)
    sheet = svg.Sheet(LANE_WIDTH, height, heading, f"Distribution of {heading}")
    everything = [value for _, _, values in lanes for value in values]
    axis = svg.axis_over(everything, LANE_LEFT, LANE_RIGHT)
    svg.x_grid(sheet, axis, 28, height - 24)
    for index, (name, color, values) in enumerate(lanes):
        y = 32 + LANE_HEIGHT * (index + 0.5)
        sheet.text(LANE_LEFT - 10, y + 4, name, 11, svg.INK, "end")
        _lane(sheet, axis, y, color, values)
    return sheet.svg()


def _lane(sheet: svg.Sheet, axis: svg.Axis, y: float, color: str, values: Sequence[float]) -> None:
    ordered = np.sort(np.asarray(values, dtype=float))
    shown = ordered
    if len(ordered) > MAX_LANE_DOTS:
        shown = np.quantile(ordered, np.linspace(0, 1, MAX_LANE_DOTS))
    radius = 3.2 if len(shown) <= 60 else 1.8
    for x, row in _swarm(np.array([axis.at(value) for value in shown]), 2 * radius):
        sheet.dot(x, y + 2 - row, radius, color, 0.75)
    low, middle, high = (axis.at(q) for q in np.quantile(ordered, [0.25, 0.5, 0.75]))
    sheet.rect(low, y + 10, high - low, 8, color, 0.35)
    sheet.line(middle, y + 7, middle, y + 21, color, 2.5)
    sheet.line(axis.at(ordered[0]), y + 14, low, y + 14, color, 1.2)
    sheet.line(high, y + 14, axis.at(ordered[-1]), y + 14, color, 1.2)


def _swarm(xs: np.ndarray, size: float) -> list[tuple[float, float]]:
    """Return positions of dots, stacked to avoid overlap.

    High stacks are compressed evenly, so that their shape remains.
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


def distributions(data: StudyData) -> str:
    """Return one chart per outcome, with a lane for each mode."""
    charts = []
    for outcome in MAIN_OUTCOMES:
        lanes = []
        for index, mode in enumerate(data.modes):
            values = values_of(data.of_mode(mode), outcome.name)
            if values:
                lanes.append((short_mode_title(mode), svg.mode_color(mode, index), values))
        if lanes:
            charts.append(distribution_chart(outcome.heading, lanes))
    caption = "All trials; below the dots the middle half, the median, and the whole range."
    return page.section("Distributions", page.figure(charts, caption))


def motion(data: StudyData, comparisons: Sequence[ModeComparison]) -> str:
    """Return the table; "" if no trial was recorded."""
    found = {name for trial in data.trials for name in trial.values}
    outcomes = [outcome for outcome in MOTION_OUTCOMES if outcome.name in found]
    if not outcomes:
        return ""
    compared = {c.outcome.name: result for c, result in tested(comparisons)}
    rows = []
    for outcome in outcomes:
        values = [values_of(data.of_mode(mode), outcome.name) for mode in data.modes]
        means = [_mean_and_sd(own, outcome.digits) if own else "–" for own in values]
        counts = " / ".join(str(len(own)) for own in values)
        result, effect = compared.get(outcome.name), "–"
        if result is not None and result.hedges_gz is not None and result.gz_interval is not None:
            effect = interval_text(result.hedges_gz, result.gz_interval, 2)
        n = "–" if result is None else str(result.n)
        rows.append([outcome.heading, *means, counts, n, effect])
    definitions = [
        [outcome.title, page.text(outcome.definition), page.text(outcome.source)]
        for outcome in outcomes
    ]
    modes = [mode_title(mode) for mode in data.modes]
    return page.section(
        "Motion metrics",
        page.paragraph(
            "Mean ± standard deviation of the trials; described, not tested. g_z is of the n "
            "trainees who did both modes."
        ),
        page.table([["Metric", *modes, "trials", "n", "g_z [95 %]"]], rows),
        page.table(
            [["Metric", page.text("Definition"), page.text("Source")]],
            definitions,
        ),
    )


def _mean_and_sd(values: Sequence[float], digits: int) -> str:
    text = fixed(float(np.mean(values)), digits)
    if len(values) > 1:
        text += f" ± {fixed(float(np.std(values, ddof=1)), digits)}"
    return text
