"""An arrow at the picture's edge toward a target that is out of sight, with the distance."""

from __future__ import annotations

import math

import numpy as np

from rastrainer_simulator.desktop import theme
from rastrainer_simulator.desktop.canvas import Box, Canvas
from rastrainer_simulator.desktop.panels.brush import Brush

RADIUS = 46
REACH = 78
HALF_WIDTH = 30
STEP_DEG = 3.0


def target_arrow(target: tuple[float, int], brush: Brush) -> np.ndarray:
    """Return a disk with the distance, and an arrow head on it.

    `target` is an angle in degrees, 0 to the right and 90 up, and a distance in mm.
    """
    angle_deg, distance_mm = target
    middle = brush.px(REACH) + 2
    canvas = Canvas(2 * middle, 2 * middle)
    angle = math.radians(angle_deg)
    ahead = np.array([math.cos(angle), -math.sin(angle)])
    aside = np.array([-ahead[1], ahead[0]])
    center = np.array([middle, middle], dtype=float)
    base = center + brush.px(0.6 * RADIUS) * ahead
    tip = center + brush.px(REACH) * ahead
    corners = (tip, base + brush.px(HALF_WIDTH) * aside, base - brush.px(HALF_WIDTH) * aside)
    canvas.polygon([tuple(corner) for corner in corners], theme.TARGET)
    radius = brush.px(RADIUS)
    disk = Box(middle - radius, middle - radius, 2 * radius, 2 * radius)
    canvas.box(disk, theme.NIGHT, radius)
    canvas.frame(disk, theme.TARGET, radius, brush.px(4))
    lines = ((str(distance_mm), theme.STRONG, -0.72), ("mm", theme.SMALL, 0.02))
    for text, style, rise in lines:
        left = middle - brush.width(text, style) // 2
        brush.write(canvas, text, style, theme.TEXT, left, middle + brush.px(rise * RADIUS))
    return canvas.pixels()
