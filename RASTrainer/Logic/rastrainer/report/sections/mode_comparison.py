"""The comparison of the modes, task by task, as in the paper's Fig. 8."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.report.charts.svg import FAINT, INK, Sheet, axis_over, legend, mode_color, y_grid
from rastrainer.report.html.markup import figure, section
from rastrainer.study.outcomes import MAIN_OUTCOMES, Outcome, mode_title, task_title
from rastrainer.study.study_data import StudyData

SHOWN = ("completion_time_s", "rmse_mm", "ctps", "score")


def mode_comparison(data: StudyData) -> str:
    """Return one chart an outcome: modes side by side for every task."""
    charts = [
        _chart(data, outcome)
        for outcome in MAIN_OUTCOMES
        if outcome.name in SHOWN and any(outcome.name in trial.values for trial in data.trials)
    ]
    parts = [figure([chart], "") for chart in charts[:-1]]
    last = figure(
        charts[-1:], "Modes compared task by task, as in the paper's Fig. 8, with every trial."
    )
    return section("The modes, task by task", *parts, last)


def _chart(data: StudyData, outcome: Outcome) -> str:
    series = [
        Series(
            mode_title(mode),
            mode_color(mode, index),
            tuple(
                tuple(
                    trial.values[outcome.name]
                    for trial in data.of_mode(mode)
                    if trial.task == task and outcome.name in trial.values
                )
                for task in data.tasks
            ),
        )
        for index, mode in enumerate(data.modes)
    ]
    return grouped_bars(outcome.heading, [task_title(task) for task in data.tasks], series)


WIDTH, HEIGHT = 680, 222
LEFT, RIGHT, TOP, BOTTOM = 48, 672, 42, 186
MOST_DOTS = 40


@dataclass(frozen=True)
class Series:
    """One color: its name and, for each group, the values."""

    name: str
    color: str
    values: tuple[tuple[float, ...], ...]


def grouped_bars(heading: str, groups: Sequence[str], series: Sequence[Series]) -> str:
    """Return the chart; a bar is the mean, its whisker one standard deviation, n − 1."""
    sheet = Sheet(WIDTH, HEIGHT, f"{heading} by task and mode")
    sheet.text(LEFT - 34, 16, heading, 12.5, INK, weight="600")
    legend(sheet, LEFT, 34, [(one.name, one.color) for one in series])
    everything = [value for one in series for values in one.values for value in values]
    axis = axis_over(everything, BOTTOM, TOP + 6, from_zero=True)
    y_grid(sheet, axis, LEFT, RIGHT)
    slot = (RIGHT - LEFT) / len(groups)
    width = min(46.0, slot * 0.72 / len(series))
    for column, group in enumerate(groups):
        center = LEFT + slot * (column + 0.5)
        for index, one in enumerate(series):
            x = center + (index - (len(series) - 1) / 2) * width
            if one.values[column]:
                _bar(sheet, axis, x, width * 0.88, one.color, one.values[column])
        sheet.text(center, HEIGHT - 18, group, 11, INK, "middle")
    sheet.text(LEFT, HEIGHT - 3, "bar: mean; whisker: ± 1 SD; dot: one trial", 9.5, FAINT)
    return sheet.svg()


def _bar(sheet: Sheet, axis, x: float, width: float, color: str, values: Sequence[float]) -> None:
    mean = float(np.mean(values))
    zero, top = axis.at(0.0), axis.at(mean)
    sheet.rect(x - width / 2, min(zero, top), width, abs(zero - top), color, 0.32)
    sheet.line(x - width / 2, top, x + width / 2, top, color, 2.2)
    if len(values) > 1:
        sd = float(np.std(values, ddof=1))
        sheet.line(x, axis.at(mean - sd), x, axis.at(mean + sd), color, 1.2)
    shown = (
        values if len(values) <= MOST_DOTS else np.quantile(values, np.linspace(0, 1, MOST_DOTS))
    )
    for index, value in enumerate(shown):
        spread = ((index * 0.618) % 1.0 - 0.5) * width * 0.55
        sheet.dot(x + spread, axis.at(value), 2.4, color, 0.9)
