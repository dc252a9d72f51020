"""A stick to be dragged by the mouse: where it is in the window, and what it looks like."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.desktop.panels.canvas import Box, Canvas

DIAMETER, KNOB = 264, 88
ABOVE_HINTS = 172
"""How far a stick's lower end is above the window's."""
_TEXT_SHARE, _TEXT_TOP = 0.6, 0.66


@dataclass(frozen=True)
class StickLook:
    """One stick.

    Attributes:
        label: what it does.
        x, y: how far it is pushed right and up, −1 to 1 each.
    """

    label: str
    x: float = 0.0
    y: float = 0.0


def stick_boxes(size: tuple[int, int]) -> tuple[Box, Box]:
    """Return where the left and the right stick are in a window of so many pixels."""
    brush = Brush(theme.scale_of(*size))
    wide, margin = brush.px(DIAMETER), brush.px(theme.MARGIN)
    top = size[1] - brush.px(ABOVE_HINTS) - wide
    return Box(margin, top, wide, wide), Box(size[0] - margin - wide, top, wide, wide)


def knob_box(stick: Box, look: StickLook, brush: Brush) -> Box:
    """Return where the knob of a stick is."""
    wide = brush.px(KNOB)
    reach = (stick.width - wide) / 2.0
    left = stick.left + reach + reach * look.x
    top = stick.top + reach - reach * look.y
    return Box(round(left), round(top), wide, wide)


def paint_stick(label: str, brush: Brush) -> np.ndarray:
    """Return the ground of a stick with what it does."""
    wide = brush.px(DIAMETER)
    canvas, whole = Canvas(wide, wide), Box(0, 0, wide, wide)
    canvas.box(whole, theme.GLASS, wide / 2)
    canvas.frame(whole, theme.TEXT, wide / 2, brush.px(3))
    top = round(_TEXT_TOP * wide)
    for line in brush.wrap(label, theme.SMALL, _TEXT_SHARE * wide):
        left = (wide - brush.width(line, theme.SMALL)) // 2
        brush.write(canvas, line, theme.SMALL, theme.TEXT, left, top)
        top += brush.line_height(theme.SMALL)
    return canvas.pixels()


def paint_knob(is_pushed: bool, brush: Brush) -> np.ndarray:
    """Return the knob of a stick."""
    wide = brush.px(KNOB)
    canvas, whole = Canvas(wide, wide), Box(0, 0, wide, wide)
    canvas.box(whole, theme.ACCENT, wide / 2)
    canvas.frame(whole, theme.TEXT if is_pushed else theme.ACCENT_EDGE, wide / 2, brush.px(4))
    return canvas.pixels()
