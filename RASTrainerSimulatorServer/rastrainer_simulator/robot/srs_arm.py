"""A 7R S-R-S arm as plain floats for FABRIK's inner loops.

Three axes that meet in one point act as a shoulder, three as a wrist, and the elbow is where the
third, fourth and fifth axes meet (Shimizu et al. 2008, 10.1109/TRO.2008.2003266, section II). Such
an arm is the canonical chain

    Rz(θ1) Ry(θ2) · upper · Rz(θ3) Ry(θ4) · fore · Rz(θ5) Ry(θ6) · tool · Rz(θ7),

whose links are all along z at θ = 0, with θ = sign · q. The plain floats are in the arm's own
frame, parallel to World: the shoulder is the origin.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin

from rastrainer.files.urdf import Joint
from rastrainer_simulator.vectors import Vector

Angles = Sequence[float]
Limits = tuple[tuple[float, float], ...]
# Directions of upper arm, forearm and tool, then the axes of joints 2, 4 and 6: unit vectors.
Chain = tuple[Vector, Vector, Vector, Vector, Vector, Vector]

# Beyond every cosine: a bound that never binds.
_NEVER = 2.0
_SMALL_TILT = 0.05


@dataclass(frozen=True, slots=True)
class CanonicalArm:
    """Lengths in m, limits of θ in rad, and the bounds that the tilts put on directions.

    `…_cosines` bound the cosine of the angle between z and the upper arm, between upper arm and
    forearm, between forearm and tool. The elbow's tilt keeps the wrist between `nearest` and
    `farthest` from the shoulder.
    """

    shoulder: float  # above World's origin
    upper: float
    fore: float
    tool: float
    signs: tuple[float, ...]
    limits: Limits
    shoulder_cosines: tuple[float, float]
    elbow_cosines: tuple[float, float]
    wrist_cosines: tuple[float, float]
    nearest: float
    farthest: float
    reach: float  # the stretched arm's

    @classmethod
    def of(
        cls,
        shoulder: float,
        upper: float,
        fore: float,
        tool: float,
        signs: Sequence[float],
        joints: Sequence[Joint],
    ) -> CanonicalArm:
        """Return an arm with the shoulder at a height above World's origin; all in m."""
        limits = tuple(
            (joint.lower, joint.upper) if sign > 0.0 else (-joint.upper, -joint.lower)
            for sign, joint in zip(signs, joints, strict=True)
        )
        elbow = tilt_range(*limits[3])
        farthest, nearest = (
            math.sqrt(max(0.0, upper * upper + fore * fore + 2.0 * upper * fore * cos(bend)))
            for bend in elbow
        )
        return cls(
            shoulder=shoulder,
            upper=upper,
            fore=fore,
            tool=tool,
            signs=tuple(signs),
            limits=limits,
            shoulder_cosines=_cosines(tilt_range(*limits[1])),
            elbow_cosines=_cosines(elbow),
            wrist_cosines=_cosines(tilt_range(*limits[5])),
            nearest=nearest,
            farthest=farthest,
            reach=upper + fore + tool,
        )


def tilt_range(lower: float, upper: float) -> tuple[float, float]:
    """Return the smallest and largest angle that a tilt can make, its pan being free."""
    sizes = sorted((abs(lower), abs(upper)))
    return (0.0 if lower <= 0.0 <= upper else sizes[0], min(sizes[1], math.pi))


def inside(theta: Angles, limits: Limits) -> bool:
    """Return whether each θ is within its limits."""
    t1, t2, t3, t4, t5, t6, t7 = theta
    (a1, b1), (a2, b2), (a3, b3), (a4, b4), (a5, b5), (a6, b6), (a7, b7) = limits
    return (
        a1 <= t1 <= b1
        and a2 <= t2 <= b2
        and a3 <= t3 <= b3
        and a4 <= t4 <= b4
        and a5 <= t5 <= b5
        and a6 <= t6 <= b6
        and a7 <= t7 <= b7
    )


def clamped(theta: Angles, limits: Limits) -> tuple[float, ...]:
    return tuple([min(max(a, low), high) for a, (low, high) in zip(theta, limits, strict=True)])


def _cosines(tilts: tuple[float, float]) -> tuple[float, float]:
    smallest, largest = tilts
    return (
        cos(largest) if largest < math.pi else -_NEVER,
        cos(smallest) if smallest > 0.0 else _NEVER,
    )


def chain(theta: Angles) -> Chain:
    """Return where links and axes point. Joints 1, 3, 5 and 7 turn about z and the three links."""
    t1, t2, t3, t4, t5, t6, _ = theta
    s1, c1, s2, c2 = sin(t1), cos(t1), sin(t2), cos(t2)
    s3, c3, s4, c4 = sin(t3), cos(t3), sin(t4), cos(t4)
    s5, c5, s6, c6 = sin(t5), cos(t5), sin(t6), cos(t6)
    ux, uy, uz = c1 * s2, s1 * s2, c2
    # Rz(θ1) Ry(θ2) Rz(θ3): x and y; then Ry(θ4) turns x, and z becomes the forearm.
    p, r = c1 * c2, s1 * c2
    xx, xy, xz = c3 * p - s3 * s1, c3 * r + s3 * c1, -c3 * s2
    ex, ey, ez = -s3 * p - c3 * s1, c3 * c1 - s3 * r, s3 * s2
    fx, fy, fz = s4 * xx + c4 * ux, s4 * xy + c4 * uy, s4 * xz + c4 * uz
    xx, xy, xz = c4 * xx - s4 * ux, c4 * xy - s4 * uy, c4 * xz - s4 * uz
    # Rz(θ5) turns x and y; then Ry(θ6) makes z the tool.
    wx, wy, wz = c5 * ex - s5 * xx, c5 * ey - s5 * xy, c5 * ez - s5 * xz
    xx, xy, xz = c5 * xx + s5 * ex, c5 * xy + s5 * ey, c5 * xz + s5 * ez
    tx, ty, tz = s6 * xx + c6 * fx, s6 * xy + c6 * fy, s6 * xz + c6 * fz
    return (ux, uy, uz), (fx, fy, fz), (tx, ty, tz), (-s1, c1, 0.0), (ex, ey, ez), (wx, wy, wz)


def tip(arm: CanonicalArm, links: Chain) -> Vector:
    (ux, uy, uz), (fx, fy, fz), (tx, ty, tz), *_ = links
    a, b, c = arm.upper, arm.fore, arm.tool
    return (a * ux + b * fx + c * tx, a * uy + b * fy + c * ty, a * uz + b * fz + c * tz)


def clear(theta: Angles, small: float = _SMALL_TILT) -> bool:
    """Return whether shoulder, elbow and wrist are clear of their singularities by `small` rad."""
    return not (-small < theta[1] < small or -small < theta[3] < small or -small < theta[5] < small)
