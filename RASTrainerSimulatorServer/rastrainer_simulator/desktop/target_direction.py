"""Where in the picture a target is, or in which direction out of it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from vtkmodules.vtkRenderingCore import vtkRenderer

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
