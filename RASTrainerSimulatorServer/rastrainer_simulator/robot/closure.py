"""Close the chain exactly: from wrist and tool to joint angles inside the limits."""

from __future__ import annotations

from math import inf

from rastrainer_simulator.robot.branches import Roll, joint_angles, nearest_branch
from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm
from rastrainer_simulator.robot.elbow_circle import (
    ElbowCircle,
    elbows_at_limits,
    nearest_elbow,
    tilts_allow,
)
from rastrainer_simulator.vectors import Vector


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

    The elbow is the feasible one nearest to φ = 0 of its circle, the branch the one nearest to
    `last`. Where that leaves a joint more than `farthest` (rad) from `last`, an elbow at a limit is
    taken if it avoids such a jump.
    """
    (cx, cy, cz), (sx, sy, sz), _ = circle
    elbow = (cx + sx, cy + sy, cz + sz)
    if not tilts_allow(arm, elbow, wrist, tool):
        nearest = nearest_elbow(arm, circle, wrist, tool)
        if nearest is None:
            return None
        elbow = nearest
    theta = _branch(arm, elbow, wrist, tool, roll, last)
    if theta is not None and _near(theta, last, farthest):
        return theta
    for elbow in elbows_at_limits(arm, circle, wrist, tool, roll):
        other = _branch(arm, elbow, wrist, tool, roll, last)
        if other is not None and _near(other, last, farthest):
            return other
        theta = theta or other
    return theta


def close_at(
    arm: CanonicalArm, elbow: Vector, wrist: Vector, tool: Vector, roll: Roll, last: Angles
) -> Angles | None:
    """Do as `close` with the elbow at a given place of its circle, None where it cannot be."""
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


def _near(theta: Angles, last: Angles, farthest: float) -> bool:
    a1, a2, a3, a4, a5, a6, a7 = theta
    b1, b2, b3, b4, b5, b6, b7 = last
    return (
        -farthest <= a1 - b1 <= farthest
        and -farthest <= a2 - b2 <= farthest
        and -farthest <= a3 - b3 <= farthest
        and -farthest <= a4 - b4 <= farthest
        and -farthest <= a5 - b5 <= farthest
        and -farthest <= a6 - b6 <= farthest
        and -farthest <= a7 - b7 <= farthest
    )
