"""A ring about the tool's tip that closes as the tip comes nearer to the head."""

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
