"""With wrist and tool held, slide the elbow along its circle to where the joints move least.

The one freedom that is left turns upper arm and forearm about the line from shoulder to wrist. Its
joint rates have a closed form, so the angle of least squares is one division (Gauss–Newton).
"""

from __future__ import annotations

from itertools import islice
from math import inf, sqrt

from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm, Chain, chain, clear
from rastrainer_simulator.robot.closure import close
from rastrainer_simulator.robot.elbow_circle import elbow_circle, elbows_that_keep_a_pan
from rastrainer_simulator.robot.goal import Goal
from rastrainer_simulator.vectors import Vector, scale

_FLAT = 1e-9
_NO_MOTION = 2e-4
# Squared: what no step of teleoperation asks of a joint away from a singularity, rad.
_LEAP = 0.02 * 0.02
_MOST_SLIDES = 4
_MOST_KEPT = 4


def with_least_motion(
    arm: CanonicalArm, theta: Angles, wrist: Vector, goal: Goal, last: Angles, guess: Vector
) -> Angles:
    """Return θ with the elbow near `guess` (m) from where the joints move least from `last`.

    `theta` already holds the wrist (m) and the goal's tool, and so does what is returned.
    """
    theta = _slide(arm, theta, wrist, goal, last)
    if _motion(theta, last) < _LEAP:
        return theta
    # Close to a singularity the nearest elbow can need a pan to turn far: try to keep each.
    circle = elbow_circle(arm, wrist, guess)
    elbows = elbows_that_keep_a_pan(arm, circle, wrist, goal.tool, goal.roll, last)
    for elbow in islice(elbows, _MOST_KEPT):
        kept = close(arm, wrist, goal.tool, goal.roll, elbow, last)
        if kept is not None and _motion(kept, last) < _motion(theta, last):
            theta = kept
    return _slide(arm, theta, wrist, goal, last)


def _slide(arm: CanonicalArm, theta: Angles, wrist: Vector, goal: Goal, last: Angles) -> Angles:
    for _ in range(_MOST_SLIDES):
        links = chain(theta)
        angle, motion = _slide_angle(arm, theta, links, last, goal.roll is not None)
        if motion < _NO_MOTION:
            break
        elbow = elbow_circle(arm, wrist, scale(links[0], arm.upper)).at(angle)
        slid = close(arm, wrist, goal.tool, goal.roll, elbow, last)
        if slid is None or _motion(slid, last) >= _motion(theta, last):
            break
        theta = slid
        if clear(theta):
            break
    return theta


def _motion(theta: Angles, last: Angles) -> float:
    return sum([(a - b) * (a - b) for a, b in zip(theta, last, strict=True)])


def _slide_angle(
    arm: CanonicalArm, theta: Angles, links: Chain, last: Angles, rolls: bool
) -> tuple[float, float]:
    """Return the angle (rad) that brings θ nearest to `last`, and how far the joints then move.

    `links` is the chain of θ; `rolls` tells whether the tool's roll is held too.
    """
    (ux, uy, uz), (fx, fy, fz), tool, axis2, _, axis6 = links
    a, b = arm.upper, arm.fore
    wx, wy, wz = a * ux + b * fx, a * uy + b * fy, a * uz + b * fz
    size = sqrt(wx * wx + wy * wy + wz * wz)
    axis = (wx / size, wy / size, wz / size)
    pan, tilt, turn = _rates(axis, (0.0, 0.0, 1.0), axis2, links[0])
    # Seen from the hand, which stays, it is the forearm that turns back.
    roll, wrist_tilt, wrist_pan = _rates(axis, tool, axis6, links[1])
    rates = (pan, tilt, turn, 0.0, -wrist_pan, -wrist_tilt, -roll if rolls else 0.0)
    square = sum([rate * rate for rate in rates])
    if not _FLAT < square < inf:
        return 0.0, 0.0
    along = sum([rate * (a - b) for rate, a, b in zip(rates, theta, last, strict=True)])
    return -along / square, abs(along) / sqrt(square)


def _rates(spin: Vector, first: Vector, second: Vector, third: Vector) -> Vector:
    """Split a rotation into rates about three axes, the second perpendicular to the others."""
    sx, sy, sz = spin
    ax, ay, az = first
    bx, by, bz = second
    cx, cy, cz = third
    # Perpendicular to the second and third axes: only the first contributes along it.
    px, py, pz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
    lever = ax * px + ay * py + az * pz
    if abs(lever) < _FLAT:
        return inf, 0.0, inf
    rate = (sx * px + sy * py + sz * pz) / lever
    return (
        rate,
        sx * bx + sy * by + sz * bz,
        sx * cx + sy * cy + sz * cz - rate * (ax * cx + ay * cy + az * cz),
    )
