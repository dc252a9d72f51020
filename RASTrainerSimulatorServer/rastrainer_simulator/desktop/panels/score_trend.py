"""A trainee's scores as bars, with the pass mark as a line."""

from __future__ import annotations

from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.desktop.panels.canvas import Box, Canvas
from rastrainer_simulator.net.views.screen import ScoreTrend, Tone

_PLOT_HEIGHT = 0.55
"""Of a plot as large as its column is wide."""
_BROADEST_BAR = 8 * theme.STEP
_BAR_SHARE = 0.72
"""Of the distance from one bar to the next."""


def trend_height(brush: Brush, width: int) -> int:
    """Return how many pixels a plot of this width is high."""
    return brush.line_height(theme.SMALL_STRONG) + round(_PLOT_HEIGHT * width)


def draw_trend(canvas: Canvas, place: Box, trend: ScoreTrend, brush: Brush) -> None:
    """Draw the plot at the top of a place: a full bar is a score of 100."""
    height = round(_PLOT_HEIGHT * place.width)
    bottom = place.top + trend_height(brush, place.width)
    step = min(place.width / len(trend.scores), brush.px(_BROADEST_BAR))
    bars = []
    for number, score in enumerate(trend.scores):
        high = max(brush.px(2), round(height * score / 100.0))
        left = place.left + round(number * step)
        bars.append(Box(left, bottom - high, max(1, round(_BAR_SHARE * step)), high))
        has_passed = trend.mark > 0.0 and score >= trend.mark
        color = theme.TONES[Tone.GOOD if has_passed else Tone.PLAIN]
        canvas.box(bars[-1], color, brush.px(4))
    rule = brush.px(2)
    canvas.box(Box(place.left, bottom, place.width, rule), theme.CAP_EDGE)
    if trend.mark > 0.0:
        level = bottom - round(height * trend.mark / 100.0)
        canvas.box(Box(place.left, level, place.width, rule), theme.TARGET)
    _write_over(canvas, bars[-1], place, f"{trend.scores[-1]:.0f}", brush)


def _write_over(canvas: Canvas, bar: Box, place: Box, text: str, brush: Brush) -> None:
    """Write a number above a bar, within the plot."""
    width = brush.width(text, theme.SMALL_STRONG)
    left = max(place.left, bar.left + (bar.width - width) // 2)
    top = bar.top - brush.line_height(theme.SMALL_STRONG)
    brush.write(canvas, text, theme.SMALL_STRONG, theme.TEXT, left, top)
