"""Every trainee's values from trial to trial, with the curve of all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from rastrainer.number_text import significant
from rastrainer.report.charts.svg import FAINT, INK, Axis, Sheet, axis_over, y_grid

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
    """Return the chart.

    Args:
        heading: With the unit.
        color: Of the mode.
        trainees: Pseudonym → points (trial number, value).
        x_title: Below the axis.
        curve: A fitted curve; the means are joined where there is none.
        span: Values that the axis shall hold besides, so that charts can be compared.
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
