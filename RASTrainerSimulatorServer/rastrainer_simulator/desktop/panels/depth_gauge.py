"""The depth ruler: how deep drill or instrument is, beside the planned entry, skull and target."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.desktop.panels.canvas import Box, Canvas
from rastrainer_simulator.net.views.screen import DepthRuler
from rastrainer_simulator.ops.texts.texts import Texts

WIDTH, HEIGHT = 260, 520
TRACK_LEFT, TRACK_WIDTH, TRACK_TOP, TRACK_BOTTOM = 96, 44, 76, 24
TICK_MM = 10.0
BEYOND_MM = 10.0
"""So far past the target the scale goes."""


@dataclass(frozen=True)
class DepthGauge:
    """What is drawn, mm: the scale, and how deep what is in the guide is beyond its tip.

    `figure` is that depth as it is written.
    """

    ruler: DepthRuler
    depth_mm: float
    figure: str

    @property
    def longest_mm(self) -> float:
        """Length of the scale."""
        return max(self.ruler.target, self.depth_mm, 1.0) + BEYOND_MM


def depth_gauge(
    ruler: DepthRuler | None, procedure: Mapping[str, Any] | None, texts: Texts
) -> DepthGauge | None:
    """Return what a screen's ruler and a state's procedure say; None while nothing is fed."""
    if ruler is None or procedure is None:
        return None
    depth_mm = round(procedure["feedMm"], 1)
    return DepthGauge(ruler, depth_mm, texts.say("panel.mm", value=depth_mm))


def paint_gauge(look: DepthGauge, brush: Brush) -> np.ndarray:
    """Return the panel: depths from the top down, bone as a pale band, lines at the marks."""
    canvas = Canvas(brush.px(WIDTH), brush.px(HEIGHT))
    canvas.box(Box(0, 0, canvas.width, canvas.height), theme.GLASS, brush.px(theme.RADIUS))
    top, bottom = brush.px(TRACK_TOP), brush.px(HEIGHT - TRACK_BOTTOM)
    left, wide = brush.px(TRACK_LEFT), brush.px(TRACK_WIDTH)

    def y(depth_mm: float) -> int:
        return round(top + (bottom - top) * max(depth_mm, 0.0) / look.longest_mm)

    canvas.box(Box(left, top, wide, bottom - top), theme.FIELD, 4)
    ruler = look.ruler
    if ruler.outer is not None and ruler.inner is not None:
        bone = Box(left, y(ruler.outer), wide, max(1, y(ruler.inner) - y(ruler.outer)))
        canvas.box(bone, theme.CAP_EDGE, 0)
    canvas.box(Box(left + wide // 3, top, wide // 3, y(look.depth_mm) - top), theme.ACCENT, 0)
    for tick in np.arange(0.0, look.longest_mm, TICK_MM):
        canvas.box(Box(left - brush.px(14), y(tick), brush.px(14), 2), theme.TEXT_PALE, 0)
        if tick % (2 * TICK_MM) == 0.0:
            text = f"{tick:.0f}"
            start = left - brush.px(22) - brush.width(text, theme.SMALL)
            height = brush.line_height(theme.SMALL)
            brush.write(canvas, text, theme.SMALL, theme.TEXT_SOFT, start, y(tick) - height // 2)
    _marks(canvas, look, brush, y)
    brush.write(canvas, look.figure, theme.HEADING, theme.TEXT, brush.px(theme.PAD), brush.px(18))
    return canvas.pixels()


def _marks(canvas: Canvas, look: DepthGauge, brush: Brush, y: Callable[[float], int]) -> None:
    """Mark entry, tables of the skull and target, with their depths beside the track."""
    ruler = look.ruler
    marks = (
        (ruler.entry, theme.ON_SKIN),
        (ruler.outer, theme.TARGET),
        (ruler.inner, theme.TARGET),
        (ruler.target, theme.ON_SKIN),
    )
    left = brush.px(TRACK_LEFT) - 4
    wide = brush.px(TRACK_WIDTH) + 4 + brush.px(20)
    lowest, height = -canvas.height, brush.line_height(theme.SMALL)
    for depth_mm, color in marks:
        if depth_mm is None:
            continue
        canvas.box(Box(left, y(depth_mm) - 2, wide, 4), color, 0)
        # Outer and inner table are near each other: their figures must not cover each other.
        lowest = max(y(depth_mm) - height // 2, lowest + height)
        text = f"{depth_mm:.0f}"
        brush.write(canvas, text, theme.SMALL, color, left + wide + brush.px(8), lowest)
