"""The exact closure: where the elbow can be once wrist and tool are given.

With the wrist fixed the elbow moves on a circle about the line from shoulder to wrist. Each tilt
limit cuts an arc out of it, each pan limit too, and the ends of all arcs have a closed form,
a cos φ + b sin φ + c = 0 (Shimizu et al. 2008, 10.1109/TRO.2008.2003266, section IV). The feasible
elbow nearest to φ = 0 is therefore φ = 0 itself or one of those ends.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import acos, atan2, cos, hypot, remainder, sin, sqrt
from typing import NamedTuple

from rastrainer_simulator.robot.branches import TURN, Roll
from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm
from rastrainer_simulator.vectors import Vector, any_perpendicular, cross, dot, scale

# Cosines may pass their bounds by rounding.
_SLACK = 1e-13
_TINY = 1e-15
_ROUNDING = 1e-15

# a cos φ + b sin φ + c
Wave = tuple[float, float, float]


class ElbowCircle(NamedTuple):
    """The elbow at `center` + `start` cos φ + (`axis` × `start`) sin φ, in the arm's frame, m."""

    center: Vector
    start: Vector
    axis: Vector

    def at(self, angle: float) -> Vector:
        """Return the elbow at φ = `angle`."""
        (cx, cy, cz), (x, y, z), (sx, sy, sz) = (
            self.center,
            self.start,
            cross(self.axis, self.start),
        )
        c, s = cos(angle), sin(angle)
        return (cx + x * c + sx * s, cy + y * c + sy * s, cz + z * c + sz * s)

    def turned(self, elbow: Vector, angle: float) -> Vector:
        """Return the elbow `angle` farther along the circle than one on it."""
        (cx, cy, cz), (ax, ay, az) = self.center, self.axis
        x, y, z = elbow[0] - cx, elbow[1] - cy, elbow[2] - cz
        c, s = cos(angle), sin(angle)
        return (
            cx + x * c + (ay * z - az * y) * s,
            cy + y * c + (az * x - ax * z) * s,
            cz + z * c + (ax * y - ay * x) * s,
        )

    def wave(self, normal: Vector, constant: float) -> Wave:
        """Return `normal` · elbow + `constant` as a function of φ."""
        return (
            dot(normal, self.start),
            dot(normal, cross(self.axis, self.start)),
            dot(normal, self.center) + constant,
        )


def elbow_circle(arm: CanonicalArm, wrist: Vector, guess: Vector) -> ElbowCircle:
    """Return the circle of elbows for a wrist within reach; φ = 0 is the one nearest to `guess`."""
    wx, wy, wz = wrist
    gx, gy, gz = guess
    upper = arm.upper
    square = wx * wx + wy * wy + wz * wz
    distance = sqrt(square) or _TINY
    wx, wy, wz = wx / distance, wy / distance, wz / distance
    # Law of cosines: how far along the line to the wrist the circle's center is.
    along = (upper * upper - arm.fore * arm.fore + square) / (2.0 * distance)
    part = gx * wx + gy * wy + gz * wz
    gx, gy, gz = gx - part * wx, gy - part * wy, gz - part * wz
    size = sqrt(gx * gx + gy * gy + gz * gz)
    if size < _TINY:
        (gx, gy, gz), size = any_perpendicular((wx, wy, wz)), 1.0
    square = upper * upper - along * along
    # A radius that rounding alone could make is that of a stretched arm: it has no direction.
    factor = sqrt(square) / size if square > _ROUNDING * upper * upper else 0.0
    return ElbowCircle(
        (along * wx, along * wy, along * wz), (factor * gx, factor * gy, factor * gz), (wx, wy, wz)
    )


def tilts_allow(arm: CanonicalArm, elbow: Vector, wrist: Vector, tool: Vector) -> bool:
    """Return whether the tilts of shoulder and wrist are inside their limits."""
    ex, ey, ez = elbow
    low, high = arm.shoulder_cosines
    if not low - _SLACK <= ez / arm.upper <= high + _SLACK:
        return False
    bend = (
        (wrist[0] - ex) * tool[0] + (wrist[1] - ey) * tool[1] + (wrist[2] - ez) * tool[2]
    ) / arm.fore
    low, high = arm.wrist_cosines
    return low - _SLACK <= bend <= high + _SLACK


def nearest_elbow(
    arm: CanonicalArm, circle: ElbowCircle, wrist: Vector, tool: Vector
) -> Vector | None:
    """Return the elbow nearest to φ = 0 that the tilts allow, or None."""
    waves = _tilt_waves(arm, circle, wrist, tool)
    if any(c + hypot(a, b) < 0.0 for a, b, c in waves):
        return None
    for angle in _nearest_first(waves):
        elbow = circle.at(angle)
        if tilts_allow(arm, elbow, wrist, tool):
            return elbow
    return None


def elbows_at_limits(
    arm: CanonicalArm, circle: ElbowCircle, wrist: Vector, tool: Vector, roll: Roll
) -> Iterator[Vector]:
    """Yield the elbows where a tilt or pan is at a limit, those nearest to φ = 0 first."""
    out = dot(wrist, tool)
    up, back = circle.wave((0.0, 0.0, 1.0), 0.0), circle.wave(scale(tool, -1.0), out)
    waves = []
    # A tilt's limits differ from its range where the two branches have different ones.
    for joint, cosine, length in ((1, up, arm.upper), (5, back, arm.fore)):
        a, b, c = cosine
        waves += [(a, b, c - length * cos(limit)) for limit in arm.limits[joint]]
    waves += _pans_at(_pan_waves(arm, circle, wrist, tool, roll), arm.limits)
    for angle in _nearest_first(waves):
        yield circle.at(angle)


def elbows_that_keep_a_pan(
    arm: CanonicalArm, circle: ElbowCircle, wrist: Vector, tool: Vector, roll: Roll, last: Angles
) -> Iterator[Vector]:
    """Yield the elbows where one of the pans is as in `last`, those nearest to φ = 0 first."""
    waves = _pans_at(_pan_waves(arm, circle, wrist, tool, roll), [(angle,) for angle in last])
    for angle in _nearest_first(waves):
        yield circle.at(angle)


def _pans_at(pans: dict[int, tuple[Wave, Wave]], angles: Sequence[tuple[float, ...]]) -> list[Wave]:
    """Return what vanishes where a pan is at one of the `angles` of its joint, or turned by π."""
    waves = []
    for joint, (sine, cosine) in pans.items():
        for angle in angles[joint]:
            c, s = cos(angle), sin(angle)
            (ax, ay, az), (bx, by, bz) = sine, cosine
            waves.append((ax * c - bx * s, ay * c - by * s, az * c - bz * s))
    return waves


def _tilt_waves(arm: CanonicalArm, circle: ElbowCircle, wrist: Vector, tool: Vector) -> list[Wave]:
    """Return values that are negative where the tilt of shoulder or wrist exceeds its limits."""
    up, back, out = (0.0, 0.0, 1.0), scale(tool, -1.0), dot(wrist, tool)
    waves = []
    low, high = arm.shoulder_cosines
    if low > -1.0:
        waves.append(circle.wave(up, -low * arm.upper))
    if high < 1.0:
        waves.append(circle.wave((0.0, 0.0, -1.0), high * arm.upper))
    low, high = arm.wrist_cosines
    if low > -1.0:
        waves.append(circle.wave(back, out - low * arm.fore))
    if high < 1.0:
        waves.append(circle.wave(tool, high * arm.fore - out))
    return waves


def _pan_waves(
    arm: CanonicalArm, circle: ElbowCircle, wrist: Vector, tool: Vector, roll: Roll
) -> dict[int, tuple[Wave, Wave]]:
    """Return sine and cosine of each pan, by joint index, up to a common factor.

    They follow from θ3 = ∠(z × u, u × f), θ5 = ∠(u × f, f × t) and θ7 = ∠(f × t, y), with u, f, t
    the directions of upper arm, forearm and tool.
    """
    upper, fore = arm.upper, arm.fore
    wx, wy, wz = wrist
    bend = (dot(wrist, wrist) - upper * upper - fore * fore) / (2.0 * upper * fore)
    pans = {
        0: (circle.wave((0.0, 1.0, 0.0), 0.0), circle.wave((1.0, 0.0, 0.0), 0.0)),
        2: (
            circle.wave((wy, -wx, 0.0), 0.0),
            circle.wave((0.0, 0.0, bend * fore + upper), -upper * wz),
        ),
        4: (
            circle.wave(cross(wrist, tool), 0.0),
            circle.wave(scale(tool, -bend * upper - fore), bend * upper * dot(wrist, tool)),
        ),
    }
    if roll:
        x, y = roll
        pans[6] = (circle.wave(scale(y, -1.0), dot(wrist, y)), circle.wave(x, -dot(wrist, x)))
    return pans


def _nearest_first(waves: list[Wave]) -> list[float]:
    """Return every φ within ±π at which one of the waves vanishes, the smallest first."""
    roots: list[float] = []
    for a, b, c in waves:
        size = hypot(a, b)
        if size > abs(c):
            middle, half = atan2(b, a), acos(-c / size)
            roots += (middle - half, middle + half)
    return sorted([remainder(root, TURN) for root in roots], key=abs)
