"""From the directions of the links to joint angles, on the branch nearest to the last q.

A shoulder, elbow or wrist is a pan and a tilt: turning the pan by π and mirroring the tilt gives
the same direction. Two choices at each of three places make eight branches (Shimizu et al. 2008,
10.1109/TRO.2008.2003266, section III).
"""

from __future__ import annotations

from itertools import product
from math import atan2, copysign, cos, inf, pi, remainder, sin, sqrt

from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm, inside
from rastrainer_simulator.vectors import Vector

TURN = 2.0 * pi
_PI2 = pi * pi
# A tilt below this leaves its pan free; the tip moves by less than 2e-10 m.
_STRAIGHT = 1e-10
# Below this the normal of two links, a small difference, is less exact than the pan it gave.
_NEARLY_STRAIGHT = 1e-3
# Rounding may carry an angle this far past its limit; it is then put onto the limit.
_SLACK = 1e-11

Roll = tuple[Vector, Vector] | None


def joint_angles(
    upper: Vector,
    fore: Vector,
    tool: Vector,
    roll: Roll,
    last: Angles,
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
    if angle < lower - _SLACK:
        angle += TURN
    elif angle > upper + _SLACK:
        angle -= TURN
    if lower - _SLACK <= angle <= upper + _SLACK:
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
