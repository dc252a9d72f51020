"""What leads the tip: a ring that closes near the head, an arrow toward a target out of sight."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from vtkmodules.vtkRenderingCore import vtkRenderer

from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.desktop.panels.canvas import Box, Canvas
from rastrainer_simulator.state import TOUCH_ERRORS, TouchStage

CLOSED_MM = 5.0
"""Radius of the ring on the skin; above it, it is larger by the clearance."""
THICKNESS = 4
THICKNESS_ON_SKIN = 9
STEP_PX = 2


@dataclass(frozen=True)
class TouchRing:
    """Where the ring is in the picture, in pixels from the upper left corner."""

    x: int
    y: int
    radius: int
    stage: TouchStage


def touch_ring(
    state: Mapping[str, Any], tip: np.ndarray, renderer: vtkRenderer, size: tuple[int, int]
) -> TouchRing | None:
    """Return the ring of a state; None where the tip is far from the head or not in the picture.

    Args:
        state: of the simulator, as a view receives it.
        tip: (3,) float, World, m.
        renderer: of the main view.
        size: of the window, in pixels.
    """
    stage = TouchStage(state["touch"])
    if stage is TouchStage.FAR:
        return None
    camera = renderer.GetActiveCamera()
    matrix = camera.GetCompositeProjectionTransformMatrix(size[0] / size[1], -1.0, 1.0)
    x, y, _z, w = matrix.MultiplyPoint((*tip, 1.0))
    if w <= 0.0 or abs(x) > w or abs(y) > w:
        return None
    half_height_m = w * math.tan(math.radians(camera.GetViewAngle()) / 2.0)
    radius_m = (CLOSED_MM + max(0.0, state["clearanceMm"])) / MM_PER_M
    radius = 0.5 * size[1] * radius_m / half_height_m
    return TouchRing(
        round(0.5 * size[0] * (1.0 + x / w)),
        round(0.5 * size[1] * (1.0 - y / w)),
        STEP_PX * round(radius / STEP_PX),
        stage,
    )


def paint_ring(look: tuple[int, TouchStage], brush: Brush) -> np.ndarray:
    """Return a ring of a radius in pixels, in the color of its stage."""
    radius, stage = look
    is_on_skin = stage is TouchStage.ON_SKIN
    thickness = brush.px(THICKNESS_ON_SKIN if is_on_skin else THICKNESS)
    reach = radius + thickness
    canvas = Canvas(2 * reach, 2 * reach)
    color = theme.ON_SKIN if is_on_skin else theme.NEAR
    if stage in TOUCH_ERRORS:
        color = theme.CONTACT
    canvas.frame(Box(0, 0, 2 * reach, 2 * reach), color, reach, thickness)
    return canvas.pixels()


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
