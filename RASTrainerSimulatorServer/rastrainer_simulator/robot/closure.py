"""The exact closure: for a given wrist and tool, the possible elbows, and the joint angles.

If the wrist is fixed, the elbow moves on a circle about the line from shoulder to wrist. Each tilt
limit cuts an arc out of it, each pan limit too, and the ends of all arcs have a closed form,
a cos φ + b sin φ + c = 0 (Shimizu et al. 2008, 10.1109/TRO.2008.2003266, section IV). The feasible
elbow nearest to φ = 0 is therefore φ = 0 itself or one of those ends.

A shoulder, elbow or wrist is a pan and a tilt: turning the pan by π and mirroring the tilt gives
the same direction. Two choices at each of three places make eight branches (section III); the
branch nearest to the last q is taken.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from math import acos, atan2, copysign, cos, hypot, inf, pi, remainder, sin, sqrt
from typing import NamedTuple

from rastrainer_simulator.robot.srs_arm import Angles, CanonicalArm, inside
from rastrainer_simulator.vectors import Vector, any_perpendicular, cross, dot, scale

# Cosines may pass their bounds by rounding.
_COSINE_SLACK = 1e-13
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
    """Return the circle of elbows for a wrist within reach; φ = 0 is nearest to `guess`."""
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
    # A radius as small as a rounding error has no direction: the arm is stretched.
    factor = sqrt(square) / size if square > _ROUNDING * upper * upper else 0.0
    return ElbowCircle(
        (along * wx, along * wy, along * wz), (factor * gx, factor * gy, factor * gz), (wx, wy, wz)
    )


def tilts_allow(arm: CanonicalArm, elbow: Vector, wrist: Vector, tool: Vector) -> bool:
    """Return whether the tilts of shoulder and wrist are inside their limits."""
    ex, ey, ez = elbow
    low, high = arm.shoulder_cosines
    if not low - _COSINE_SLACK <= ez / arm.upper <= high + _COSINE_SLACK:
        return False
    bend = (
        (wrist[0] - ex) * tool[0] + (wrist[1] - ey) * tool[1] + (wrist[2] - ez) * tool[2]
    ) / arm.fore
    low, high = arm.wrist_cosines
    return low - _COSINE_SLACK <= bend <= high + _COSINE_SLACK


def nearest_elbow(
    arm: CanonicalArm, circle: ElbowCircle, wrist: Vector, tool: Vector
) -> Vector | None:
    """Return the elbow nearest to φ = 0 that the tilts allow, or None."""
    # Values that are negative where the tilt of shoulder or wrist exceeds its limits.
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
    # A tilt's limits differ from its range if the two branches have different limits.
    for joint, cosine, length in ((1, up, arm.upper), (5, back, arm.fore)):
        a, b, c = cosine
        waves += [(a, b, c - length * cos(limit)) for limit in arm.limits[joint]]
    waves += _pans_at(_pan_waves(arm, circle, wrist, tool, roll), arm.limits)
    for angle in _nearest_first(waves):
        yield circle.at(angle)


def elbows_that_keep_a_pan(
    arm: CanonicalArm, circle: ElbowCircle, wrist: Vector, tool: Vector, roll: Roll, last: Angles
) -> Iterator[Vector]:
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


TURN = 2.0 * pi
_PI2 = pi * pi
# A tilt below this leaves its pan free; the tip moves by less than 2e-10 m.
_STRAIGHT = 1e-10
# A smaller normal of two links, a small difference, is less exact than the pan it gave.
_NEARLY_STRAIGHT = 1e-3
# Rounding may carry an angle this far past its limit; it is then put onto the limit.
_ANGLE_SLACK = 1e-11

Roll = tuple[Vector, Vector] | None


def joint_angles(
    upper: Vector, fore: Vector, tool: Vector, roll: Roll, last: Angles
) -> tuple[float, ...]:
    """Return θ of the branch whose tilts are positive, pans within ±π, in rad.

    `upper`, `fore` and `tool` are unit vectors, `roll` the tool's x and y axes where its roll
    matters. Where a tilt vanishes its pan is taken from `last`, as is θ7 where the roll is free.
    """
    ux, uy, uz = upper
    fx, fy, fz = fore
    tx, ty, tz = tool
    # (px, py, 0), (ex, ey, ez), (wx, wy, wz): the axes of joints 2, 4 and 6, not normalized.
    px, py = -uy, ux
    s2 = sqrt(ux * ux + uy * uy)
    if s2 > _STRAIGHT:
        t1 = atan2(-px, py)
    else:
        t1 = last[0]
        px, py = -sin(t1), cos(t1)
    ex, ey, ez = uy * fz - uz * fy, uz * fx - ux * fz, ux * fy - uy * fx
    s4 = sqrt(ex * ex + ey * ey + ez * ez)
    t3 = atan2(px * fx + py * fy, px * ex + py * ey) if s4 > _STRAIGHT else last[2]
    if s4 < _NEARLY_STRAIGHT:
        ex, ey, ez = _turned((px, py, 0.0), upper, t3)
    wx, wy, wz = fy * tz - fz * ty, fz * tx - fx * tz, fx * ty - fy * tx
    s6 = sqrt(wx * wx + wy * wy + wz * wz)
    if s6 > _STRAIGHT:
        t5 = atan2(ex * tx + ey * ty + ez * tz, ex * wx + ey * wy + ez * wz)
    else:
        t5 = last[4]
    if s6 < _NEARLY_STRAIGHT:
        wx, wy, wz = _turned((ex, ey, ez), fore, t5)
    t7 = last[6]
    if roll:
        (xx, xy, xz), (yx, yy, yz) = roll
        t7 = atan2(wx * xx + wy * xy + wz * xz, wx * yx + wy * yy + wz * yz)
    return (
        t1,
        atan2(s2, uz),
        t3,
        atan2(s4, ux * fx + uy * fy + uz * fz),
        t5,
        atan2(s6, fx * tx + fy * ty + fz * tz),
        t7,
    )


def nearest_branch(
    arm: CanonicalArm, angles: Angles, last: Angles, rolls: bool
) -> tuple[float, ...] | None:
    """Return the branch inside the limits whose θ is nearest to `last` (least squares), or None.

    `angles` is the branch of positive tilts; `rolls`: whether θ7 has to follow the wrist.
    """
    t1, t2, t3, t4, t5, t6, t7 = angles
    l1, l2, l3, l4, l5, l6, l7 = last
    d1, d3, d5, d7 = t1 - l1, t3 - l3, t5 - l5, t7 - l7
    if not (-pi < d1 < pi and -pi < d3 < pi and -pi < d5 < pi and -pi < d7 < pi):
        d1, d3, d5, d7 = (remainder(change, TURN) for change in (d1, d3, d5, d7))
    # What it costs to turn a pan by π, or to mirror a tilt, in squared distance from `last`.
    c1, c3, c5 = _PI2 - TURN * abs(d1), _PI2 - TURN * abs(d3), _PI2 - TURN * abs(d5)
    c12 = c1 + 4.0 * t2 * l2
    c67 = 4.0 * t6 * l6 + (_PI2 - TURN * abs(d7) if rolls else 0.0)
    # Given the elbow's sign, shoulder and wrist choose theirs independently.
    straight = min(0.0, c12 + c3) + min(0.0, c67 + c5)
    mirrored = min(c3, c12) + min(c5, c67) + 4.0 * t4 * l4
    elbow = mirrored < straight
    if elbow:
        c3, c5, t4 = -c3, -c5, -t4
    shoulder, wrist = c12 + c3 < 0.0, c67 + c5 < 0.0
    if shoulder:
        d1, t2 = d1 - copysign(pi, d1), -t2
    if shoulder != elbow:
        d3 -= copysign(pi, d3)
    if elbow != wrist:
        d5 -= copysign(pi, d5)
    if wrist:
        t6 = -t6
        if rolls:
            d7 -= copysign(pi, d7)
    theta = (l1 + d1, t2, l3 + d3, t4, l5 + d5, t6, l7 + d7)
    return theta if inside(theta, arm.limits) else _nearest_inside(arm, angles, last, rolls)


def _nearest_inside(
    arm: CanonicalArm, angles: Angles, last: Angles, rolls: bool
) -> tuple[float, ...] | None:
    """Do as `nearest_branch` by trying all eight: where the nearest of all breaks a limit."""
    best, nearest = inf, None
    for shoulder, elbow, wrist in product((0, 1), repeat=3):
        turns = (shoulder, 0, shoulder ^ elbow, 0, elbow ^ wrist, 0, wrist if rolls else 0)
        signs = (0, shoulder, 0, elbow, 0, wrist, 0)
        theta = []
        for angle, turned, mirrored, before, limits in zip(
            angles, turns, signs, last, arm.limits, strict=True
        ):
            fitted = fit(-angle if mirrored else angle + pi * turned, before, limits)
            if fitted is None:
                break
            theta.append(fitted)
        else:
            cost = sum([(a - b) ** 2 for a, b in zip(theta, last, strict=True)])
            if cost < best:
                best, nearest = cost, tuple(theta)
    return nearest


def fit(angle: float, last: float, limits: tuple[float, float]) -> float | None:
    """Return `angle`, by whole turns as near to `last` as the limits allow, or None."""
    lower, upper = limits
    angle = last + remainder(angle - last, TURN)
    if angle < lower - _ANGLE_SLACK:
        angle += TURN
    elif angle > upper + _ANGLE_SLACK:
        angle -= TURN
    if lower - _ANGLE_SLACK <= angle <= upper + _ANGLE_SLACK:
        return min(max(angle, lower), upper)
    return None


def _turned(a: Vector, axis: Vector, angle: float) -> Vector:
    """Return `a` turned about the unit vector `axis`, to which it is perpendicular."""
    c, s = cos(angle), sin(angle)
    (ax, ay, az), (x, y, z) = a, axis
    return (
        c * ax + s * (y * az - z * ay),
        c * ay + s * (z * ax - x * az),
        c * az + s * (x * ay - y * ax),
    )
