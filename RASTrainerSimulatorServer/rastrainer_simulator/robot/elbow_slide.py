"""Hold wrist and tool, and slide the elbow along its circle to where the joints move least.

The one freedom that is left turns upper arm and forearm about the line from shoulder to wrist. Its
joint rates have a closed form, so the angle of least squares is one division (Gauss–Newton).
"""

from __future__ import annotations

import itertools
from math import inf, sqrt

from rastrainer_simulator.robot.closure import (
    ElbowCircle,
    Roll,
    elbow_circle,
    elbows_at_limits,
    elbows_that_keep_a_pan,
    joint_angles,
    nearest_branch,
    nearest_elbow,
    tilts_allow,
)
from rastrainer_simulator.robot.goal import Goal
from rastrainer_simulator.robot.srs_arm import Angles, CanonicalArm, Chain, chain, clear
from rastrainer_simulator.vectors import Vector, scale


def close(
    arm: CanonicalArm,
    circle: ElbowCircle,
    wrist: Vector,
    tool: Vector,
    roll: Roll,
    last: Angles,
    farthest: float = inf,
) -> Angles | None:
    """Return θ that holds the wrist and the tool's direction, and its roll where given, or None.

    It takes the feasible elbow nearest to φ = 0 of its circle, and the branch nearest to `last`. If
    that leaves a joint more than `farthest` (rad) from `last`, an elbow at a limit is taken if it
    avoids such a jump.
    """
    (cx, cy, cz), (sx, sy, sz), _ = circle
    elbow = (cx + sx, cy + sy, cz + sz)
    if not tilts_allow(arm, elbow, wrist, tool):
        nearest = nearest_elbow(arm, circle, wrist, tool)
        if nearest is None:
            return None
        elbow = nearest
    theta = None
    for place in itertools.chain((elbow,), elbows_at_limits(arm, circle, wrist, tool, roll)):
        found = _branch(arm, place, wrist, tool, roll, last)
        if found is None:
            continue
        if all(-farthest <= now - then <= farthest for now, then in zip(found, last, strict=True)):
            return found
        theta = theta or found
    return theta


def close_at(
    arm: CanonicalArm, elbow: Vector, wrist: Vector, tool: Vector, roll: Roll, last: Angles
) -> Angles | None:
    """Do as `close` with the elbow at a given place of its circle, None if it cannot be there."""
    if not tilts_allow(arm, elbow, wrist, tool):
        return None
    return _branch(arm, elbow, wrist, tool, roll, last)


def _branch(
    arm: CanonicalArm, elbow: Vector, wrist: Vector, tool: Vector, roll: Roll, last: Angles
) -> Angles | None:
    ex, ey, ez = elbow
    wx, wy, wz = wrist
    a, b = 1.0 / arm.upper, 1.0 / arm.fore
    upper = (a * ex, a * ey, a * ez)
    fore = (b * (wx - ex), b * (wy - ey), b * (wz - ez))
    angles = joint_angles(upper, fore, tool, roll, last)
    return nearest_branch(arm, angles, last, roll is not None)


_FLAT = 1e-9
_NO_MOTION = 2e-4
LEAP = 0.02 * 0.02
"""Squared motion, rad², that no step of teleoperation needs away from a singularity."""
_MAX_SLIDES = 4
_MAX_KEPT = 4


def with_least_motion(
    arm: CanonicalArm, theta: Angles, circle: ElbowCircle, wrist: Vector, goal: Goal, last: Angles
) -> Angles:
    """Return θ with the elbow where on its circle the joints move least from `last`.

    `theta` already holds the wrist (m) and the goal's tool.
    """
    theta, motion = _slide(arm, theta, circle, wrist, goal, last)
    if motion < LEAP:
        return theta
    # Close to a singularity the nearest elbow can need a pan to turn far: try to keep each.
    elbows = elbows_that_keep_a_pan(arm, circle, wrist, goal.held_tool, goal.roll, last)
    for elbow in itertools.islice(elbows, _MAX_KEPT):
        kept = _near(arm, elbow, wrist, goal, last)
        if kept is not None and squared_motion(kept, last) < motion:
            theta, motion = kept, squared_motion(kept, last)
    return _slide(arm, theta, circle, wrist, goal, last)[0]


def _slide(
    arm: CanonicalArm, theta: Angles, circle: ElbowCircle, wrist: Vector, goal: Goal, last: Angles
) -> tuple[Angles, float]:
    """Return θ after the elbow has slid, and the squared motion (rad²) from `last`."""
    motion = squared_motion(theta, last)
    for _ in range(_MAX_SLIDES):
        links = chain(theta)
        angle, distance = _slide_angle(circle.axis, theta, links, last, goal.roll is not None)
        if distance < _NO_MOTION:
            break
        elbow = circle.turned(scale(links[0], arm.upper), angle)
        slid = close_at(arm, elbow, wrist, goal.held_tool, goal.roll, last)
        if slid is None:
            slid = _near(arm, elbow, wrist, goal, last)
        if slid is None or squared_motion(slid, last) >= motion:
            break
        theta, motion = slid, squared_motion(slid, last)
        if clear(theta):
            break
    return theta, motion


def _near(
    arm: CanonicalArm, elbow: Vector, wrist: Vector, goal: Goal, last: Angles
) -> Angles | None:
    """Return θ with the elbow as near to `elbow` as the tilts allow, or None."""
    circle = elbow_circle(arm, wrist, elbow)
    return close(arm, circle, wrist, goal.held_tool, goal.roll, last)


def squared_motion(theta: Angles, last: Angles) -> float:
    """Return by how much the joints move from `last`, as a sum of squares, rad²."""
    a1, a2, a3, a4, a5, a6, a7 = theta
    b1, b2, b3, b4, b5, b6, b7 = last
    return (
        (a1 - b1) * (a1 - b1)
        + (a2 - b2) * (a2 - b2)
        + (a3 - b3) * (a3 - b3)
        + (a4 - b4) * (a4 - b4)
        + (a5 - b5) * (a5 - b5)
        + (a6 - b6) * (a6 - b6)
        + (a7 - b7) * (a7 - b7)
    )


def _slide_angle(
    axis: Vector, theta: Angles, links: Chain, last: Angles, rolls: bool
) -> tuple[float, float]:
    """Return the angle (rad) that brings θ nearest to `last`, and how far the joints then move.

    `axis` is the axis of the elbow's circle, `links` the chain of θ; `rolls`: whether the tool's
    roll is held too.
    """
    motion = self_motion(axis, links, rolls)
    if motion is None:
        return 0.0, 0.0
    r1, r2, r3, r5, r6, r7 = motion
    t1, t2, t3, _, t5, t6, t7 = theta
    l1, l2, l3, _, l5, l6, l7 = last
    along = (
        r1 * (t1 - l1)
        + r2 * (t2 - l2)
        + r3 * (t3 - l3)
        + r5 * (t5 - l5)
        + r6 * (t6 - l6)
        + r7 * (t7 - l7)
    )
    square = r1 * r1 + r2 * r2 + r3 * r3 + r5 * r5 + r6 * r6 + r7 * r7
    return -along / square, abs(along) / sqrt(square)


def self_motion(
    axis: Vector, links: Chain, rolls: bool
) -> tuple[float, float, float, float, float, float] | None:
    """Return the rates of joints 1, 2, 3, 5, 6 and 7 as the elbow turns, None if they are lost.

    `axis` is the unit vector from shoulder to wrist; joint 4 rests. Joint 7 rests too unless the
    tool's roll is held: `rolls`.
    """
    upper, fore, tool, axis2, _, axis6 = links
    r1, r2, r3 = _rates(axis, (0.0, 0.0, 1.0), axis2, upper)
    # Seen from the hand, which stays, it is the forearm that turns back.
    r7, r6, r5 = _rates(axis, tool, axis6, fore)
    if not rolls:
        r7 = 0.0
    if not _FLAT < r1 * r1 + r2 * r2 + r3 * r3 + r5 * r5 + r6 * r6 + r7 * r7 < inf:
        return None
    return r1, r2, r3, -r5, -r6, -r7


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
