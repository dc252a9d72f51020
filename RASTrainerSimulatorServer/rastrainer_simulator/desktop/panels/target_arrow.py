"""An arrow at the picture's edge toward a target that is out of sight, with the distance."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from vtkmodules.vtkRenderingCore import vtkRenderer

from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.desktop.panels.canvas import Box, Canvas

EDGE_SHARE = 0.90
"""How much of the picture, from its middle, counts as in sight."""


@dataclass(frozen=True)
class Direction:
    """From the picture's middle toward a target out of sight.

    Attributes:
        angle_deg: 0 is to the right, 90 up.
        across: −1 is the left edge, 1 the right.
        upward: −1 is the lower edge, 1 the upper.
    """

    angle_deg: float
    across: float
    upward: float


def direction_out_of_sight(
    renderer: vtkRenderer, point: np.ndarray, size: tuple[int, int]
) -> Direction | None:
    """Return the direction to a point (World, m) that the camera does not see, else None."""
    camera = renderer.GetActiveCamera()
    aspect = size[0] / size[1]
    matrix = camera.GetCompositeProjectionTransformMatrix(aspect, -1.0, 1.0)
    x, y, _z, w = matrix.MultiplyPoint((*point, 1.0))
    if w > 0.0 and abs(x) <= EDGE_SHARE * w and abs(y) <= EDGE_SHARE * w:
        return None
    # Behind the camera left and right are swapped with the sign of w.
    sign = -1.0 if w < 0.0 else 1.0
    right, up = sign * x * aspect, sign * y
    length = math.hypot(right, up) or 1.0
    right, up = right / length, up / length
    reach = min(
        aspect / abs(right) if right else math.inf,
        1.0 / abs(up) if up else math.inf,
    )
    return Direction(math.degrees(math.atan2(up, right)), right * reach / aspect, up * reach)


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
