"""Line segments: the distance of two, and one as a thin shape for FCL."""

from __future__ import annotations

import math
from collections.abc import Sequence

import fcl
import numpy as np


def segment_distance(
    a: Sequence[float], b: Sequence[float], c: Sequence[float], d: Sequence[float]
) -> float:
    """Return the distance of the segments a–b and c–d, each end three floats.

    The nearest points of the two lines, clamped to one segment after the other
    (Ericson, Real-Time Collision Detection, 2005, section 5.1.9).
    """
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = d[0] - c[0], d[1] - c[1], d[2] - c[2]
    wx, wy, wz = a[0] - c[0], a[1] - c[1], a[2] - c[2]
    uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    uv = ux * vx + uy * vy + uz * vz
    uw, vw = ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
    area = uu * vv - uv * uv
    # Parallel segments have many nearest pairs; starting from `a` finds one of them.
    s = min(max((uv * vw - vv * uw) / area, 0.0), 1.0) if area > 1e-12 * uu * vv else 0.0
    t = (uv * s + vw) / vv if vv > 0.0 else 0.0
    if not 0.0 <= t <= 1.0 or vv == 0.0:
        t = min(max(t, 0.0), 1.0)
        s = min(max((uv * t - uw) / uu, 0.0), 1.0) if uu > 0.0 else 0.0
    return math.dist(
        (a[0] + s * ux, a[1] + s * uy, a[2] + s * uz), (c[0] + t * vx, c[1] + t * vy, c[2] + t * vz)
    )


def thin_segment(start: np.ndarray, end: np.ndarray) -> fcl.CollisionObject:
    """Return the segment between two points (3,) float of the frame whose pose is set later."""
    mesh = fcl.BVHModel()
    mesh.beginModel(1, 3)
    mesh.addSubModel([start, end, (start + end) / 2.0], [[0, 1, 2]])
    mesh.endModel()
    return fcl.CollisionObject(mesh)
