"""Every trainee's two means joined by a line, and the mean difference with its interval."""

from __future__ import annotations

import numpy as np

from rastrainer.number_text import significant
from rastrainer.report.charts.svg import FAINT, INK, Sheet, axis_over, mode_color, number, y_grid
from rastrainer.report.comparisons import ModeComparison
from rastrainer.report.outcomes import mode_title

WIDTH, HEIGHT = 330, 250
TOP, BOTTOM = 40, 212
LEFT, FIRST, SECOND = 44, 82, 176
DIFFERENCE = 268


def paired_lines(comparison: ModeComparison) -> str:
    """Return the chart of one outcome; the right part has its own axis of differences."""
    outcome = comparison.outcome
    sheet = Sheet(WIDTH, HEIGHT, f"{outcome.title} of every trainee in both modes")
    sheet.text(10, 16, outcome.heading, 12.5, INK, weight="600")
    both = np.concatenate([comparison.first_means, comparison.second_means])
    axis = axis_over(both.tolist(), BOTTOM, TOP)
    y_grid(sheet, axis, LEFT, SECOND + 22)
    colors = [mode_color(mode, i) for i, mode in enumerate((comparison.first, comparison.second))]
    opacity = 0.75 if len(comparison.trainees) <= 12 else max(0.12, 8 / len(comparison.trainees))
    pairs = zip(comparison.trainees, comparison.first_means, comparison.second_means, strict=True)
    for trainee, first, second in pairs:
        sheet.polyline([(FIRST, axis.at(first)), (SECOND, axis.at(second))], FAINT, 1.1, opacity)
        for x, value, color in ((FIRST, first, colors[0]), (SECOND, second, colors[1])):
            sheet.dot(
                x,
                axis.at(value),
                3.4,
                color,
                max(opacity, 0.5),
                f"{trainee}: {significant(value, 4)}",
            )
    means = [float(comparison.first_means.mean()), float(comparison.second_means.mean())]
    sheet.polyline([(FIRST, axis.at(means[0])), (SECOND, axis.at(means[1]))], INK, 2.6)
    for x, mode in ((FIRST, comparison.first), (SECOND, comparison.second)):
        sheet.text(x, HEIGHT - 20, mode_title(mode).split(" ")[0], 11, INK, "middle")
    _difference(sheet, comparison)
    return sheet.svg()


def _difference(sheet: Sheet, comparison: ModeComparison) -> None:
    result = comparison.result
    if result is None:
        sheet.text(DIFFERENCE, (TOP + BOTTOM) / 2, "no test", 10, FAINT, "middle")
        return
    low, high = result.interval
    axis = axis_over([low, high, 0.0, 1.1 * low, 1.1 * high], BOTTOM, TOP)
    for tick in axis.ticks(4):
        y = axis.at(tick)
        sheet.line(DIFFERENCE - 22, y, DIFFERENCE + 22, y, "#9aa5b1" if tick == 0 else "#eceff2")
        sheet.text(DIFFERENCE + 28, y + 3.5, number(tick), 9.5, FAINT)
    sheet.line(DIFFERENCE, axis.at(low), DIFFERENCE, axis.at(high), INK, 2)
    for end in (low, high):
        sheet.line(DIFFERENCE - 6, axis.at(end), DIFFERENCE + 6, axis.at(end), INK, 2)
    sheet.dot(DIFFERENCE, axis.at(result.mean_difference), 5, INK)
    sheet.text(DIFFERENCE, HEIGHT - 20, "difference", 11, INK, "middle")
    sheet.text(DIFFERENCE, HEIGHT - 7, "mean, 95 % interval", 9, FAINT, "middle")
