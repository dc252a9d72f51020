"""Where FABRIK starts again when the passes from the last posture found no way to a position."""

from __future__ import annotations

from collections.abc import Iterator
from math import atan2, cos, hypot, sin, sqrt

from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm, tilt_range
from rastrainer_simulator.vectors import Vector

_TINY = 1e-12


def planar_starts(
    arm: CanonicalArm, target: Vector, last: Angles
) -> Iterator[tuple[Vector, Vector]]:
    """Yield wrists and elbows (m) in the plane of the target and the first axis.

    Near the edge of its reach the arm lies almost in that plane, and passes from elsewhere converge
    slowly.
    """
    x, y, z = target
    beside = hypot(x, y)
    pan = atan2(y, x) if beside > _TINY else last[0]
    c, s = cos(pan), sin(pan)
    largest = tilt_range(*arm.limits[1])[1]
    for part in (1.0, -1.0, 0.6, -0.6, 0.2, -0.2):
        r, h = arm.upper * sin(part * largest), arm.upper * cos(part * largest)
        for wrist_r, wrist_h in _third_corners(arm, beside - r, z - h):
            along = r + wrist_r
            yield (c * along, s * along, h + wrist_h), (c * r, s * r, h)


def _third_corners(arm: CanonicalArm, r: float, h: float) -> Iterator[tuple[float, float]]:
    """Yield where the wrist can be, from the elbow, if the target is at (r, h) from it."""
    square = r * r + h * h
    if square < _TINY:
        return
    along = (square + arm.fore * arm.fore - arm.tool * arm.tool) / (2.0 * square)
    across = arm.fore * arm.fore / square - along * along
    if across >= 0.0:
        for side in (sqrt(across), -sqrt(across)):
            yield along * r + side * h, along * h - side * r
