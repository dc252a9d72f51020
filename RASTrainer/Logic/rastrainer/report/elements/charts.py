"""Charts of a study: learning curves, paired means with their difference, and effect sizes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from rastrainer.number_text import fixed, significant
from rastrainer.report.elements.comparisons import ModeComparison, tested
from rastrainer.report.elements.svg import (
    FAINT,
    INK,
    Axis,
    Sheet,
    axis_over,
    mode_color,
    number,
    y_grid,
)
from rastrainer.study.outcomes import mode_title

WIDTH, HEIGHT = 330, 232
LEFT, RIGHT, TOP, BOTTOM = 46, 318, 32, 190


def learning_curves(
    heading: str,
    color: str,
    trainees: Mapping[str, Sequence[tuple[float, float]]],
    x_title: str,
    curve: Sequence[tuple[float, float]] = (),
    span: Sequence[float] = (),
) -> str:
    """Return the chart of every trainee's values over the trials, with the curve of all.

    Args:
        heading: With the unit.
        color: Of the mode.
        trainees: Pseudonym → points (trial number, value).
        x_title: Below the axis.
        curve: A fitted curve; by default the means are connected.
        span: Further values that the axis must include, to make charts comparable.
    """
    sheet = Sheet(WIDTH, HEIGHT, heading)
    sheet.text(10, 16, heading, 12.5, INK, weight="600")
    points = [point for own in trainees.values() for point in own]
    numbers = sorted({x for x, _ in points})
    axis = axis_over([*span, *(y for _, y in points)], BOTTOM, TOP)
    y_grid(sheet, axis, LEFT, RIGHT)
    across = Axis(numbers[0] - 0.35, numbers[-1] + 0.35, LEFT, RIGHT)
    opacity = 0.55 if len(trainees) <= 12 else max(0.08, 6 / len(trainees))
    for name, own in trainees.items():
        sheet.polyline([(across.at(x), axis.at(y)) for x, y in own], color, 1.2, opacity)
        if len(trainees) <= 24:
            for x, y in own:
                sheet.dot(across.at(x), axis.at(y), 2.6, color, 0.8, f"{name}: {significant(y, 4)}")
    means = [(x, float(np.mean([y for n, y in points if n == x]))) for x in numbers]
    sheet.polyline([(across.at(x), axis.at(y)) for x, y in curve or means], INK, 2.4)
    ticks = numbers if len(numbers) <= 12 else across.ticks(6)
    for tick in ticks:
        sheet.text(across.at(tick), BOTTOM + 16, f"{tick:g}", 10, FAINT, "middle")
    sheet.text((LEFT + RIGHT) / 2, HEIGHT - 8, x_title, 10, FAINT, "middle")
    return sheet.svg()


PAIRED_WIDTH, PAIRED_HEIGHT = 330, 250
PAIRED_TOP, PAIRED_BOTTOM = 40, 212
PAIRED_LEFT, FIRST, SECOND = 44, 82, 176
DIFFERENCE = 268


def paired_lines(comparison: ModeComparison) -> str:
    """Return the chart of one outcome; differences have their own axis on the right."""
    outcome = comparison.outcome
    sheet = Sheet(PAIRED_WIDTH, PAIRED_HEIGHT, f"{outcome.title} of every trainee in both modes")
    sheet.text(10, 16, outcome.heading, 12.5, INK, weight="600")
    both = np.concatenate([comparison.first_means, comparison.second_means])
    axis = axis_over(both.tolist(), PAIRED_BOTTOM, PAIRED_TOP)
    y_grid(sheet, axis, PAIRED_LEFT, SECOND + 22)
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
        sheet.text(x, PAIRED_HEIGHT - 20, mode_title(mode).split(" ")[0], 11, INK, "middle")
    _difference(sheet, comparison)
    return sheet.svg()


def _difference(sheet: Sheet, comparison: ModeComparison) -> None:
    result = comparison.result
    if result is None:
        sheet.text(DIFFERENCE, (PAIRED_TOP + PAIRED_BOTTOM) / 2, "no test", 10, FAINT, "middle")
        return
    low, high = result.interval
    axis = axis_over([low, high, 0.0, 1.1 * low, 1.1 * high], PAIRED_BOTTOM, PAIRED_TOP)
    for tick in axis.ticks(4):
        y = axis.at(tick)
        sheet.line(DIFFERENCE - 22, y, DIFFERENCE + 22, y, "#9aa5b1" if tick == 0 else "#eceff2")
        sheet.text(DIFFERENCE + 28, y + 3.5, number(tick), 9.5, FAINT)
    sheet.line(DIFFERENCE, axis.at(low), DIFFERENCE, axis.at(high), INK, 2)
    for end in (low, high):
        sheet.line(DIFFERENCE - 6, axis.at(end), DIFFERENCE + 6, axis.at(end), INK, 2)
    sheet.dot(DIFFERENCE, axis.at(result.mean_difference), 5, INK)
    sheet.text(DIFFERENCE, PAIRED_HEIGHT - 20, "difference", 11, INK, "middle")
    sheet.text(DIFFERENCE, PAIRED_HEIGHT - 7, "mean, 95 % interval", 9, FAINT, "middle")


EFFECTS_WIDTH, EFFECT_HEIGHT = 680, 27
EFFECTS_LEFT, EFFECTS_RIGHT = 226, 536
MAX_EFFECT_SIZE = 6.0


def effect_sizes(comparisons: Sequence[ModeComparison]) -> str:
    """Return the chart; intervals beyond the axis end in an arrow."""
    shown = [
        (comparison, result.hedges_gz, result.gz_interval)
        for comparison, result in tested(comparisons)
        if result.hedges_gz is not None and result.gz_interval is not None
    ]
    reach = max([1.0, *(abs(end) for _comparison, _gz, interval in shown for end in interval)])
    reach = min(MAX_EFFECT_SIZE, reach * 1.05)
    axis = Axis(-reach, reach, EFFECTS_LEFT, EFFECTS_RIGHT)
    height = 64 + EFFECT_HEIGHT * len(shown)
    sheet = Sheet(EFFECTS_WIDTH, height, "Effect sizes with their intervals")
    for tick in axis.ticks(8):
        x = axis.at(tick)
        sheet.line(x, 24, x, height - 32, "#7b8794" if tick == 0 else "#e3e7ec")
        sheet.text(x, height - 18, number(tick), 10, FAINT, "middle")
    for index, (comparison, gz, interval) in enumerate(shown):
        _effect_size(
            sheet, axis, 42 + EFFECT_HEIGHT * index, comparison.outcome.title, gz, interval
        )
    if shown:
        first, second = (mode_title(mode) for mode in (shown[0][0].first, shown[0][0].second))
        sheet.text(axis.at(0) - 8, 14, f"← higher with {first}", 10, FAINT, "end")
        sheet.text(axis.at(0) + 8, 14, f"higher with {second} →", 10, FAINT)
    sheet.text(
        (EFFECTS_LEFT + EFFECTS_RIGHT) / 2,
        height - 3,
        "Hedges' g_z with 95 % interval",
        10,
        FAINT,
        "middle",
    )
    return sheet.svg()


def _effect_size(
    sheet: Sheet, axis: Axis, y: float, title: str, gz: float, interval: tuple[float, float]
) -> None:
    low, high = interval
    sheet.text(EFFECTS_LEFT - 14, y + 4, title, 11, INK, "end")
    ends = [max(low, axis.low), min(high, axis.high)]
    sheet.line(axis.at(ends[0]), y, axis.at(ends[1]), y, INK, 2)
    if low < axis.low:
        sheet.text(axis.at(axis.low) - 3, y + 4, "◂", 12, INK, "middle")
    if high > axis.high:
        sheet.text(axis.at(axis.high) + 3, y + 4, "▸", 12, INK, "middle")
    if axis.low <= gz <= axis.high:
        sheet.dot(axis.at(gz), y, 5, INK)
    words = f"{fixed(gz, 2)} [{fixed(low, 2)}, {fixed(high, 2)}]"
    sheet.text(EFFECTS_RIGHT + 14, y + 4, words, 10, FAINT)
