"""Bring the chain to a goal by FABRIK's passes and the exact closure, or as near as it gets."""

from __future__ import annotations

from collections.abc import Iterator
from math import atan2, cos, hypot, inf, remainder, sin, sqrt
from typing import NamedTuple

from rastrainer_simulator.robot.branches import TURN, fit, joint_angles, nearest_branch
from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm, chain, tilt_range
from rastrainer_simulator.robot.closure import close
from rastrainer_simulator.robot.fabrik_passes import backward, forward, settle
from rastrainer_simulator.robot.goal import Goal
from rastrainer_simulator.robot.nearest_reach import nearest_links
from rastrainer_simulator.vectors import Vector, dot, length, scale, subtract

OUT_OF_REACH = "The target is out of reach; the tool is as near to it as the arm gets."
ROLL_BLOCKED = (
    "The joint limits do not allow this roll of the tool there; it is as near as it gets."
)
BLOCKED = "No posture inside the joint limits holds the tool like that; the arm stays where it is."

_SLACK = 1e-12


class Start(NamedTuple):
    """Where FABRIK starts: joint angles with their wrist and elbow (m)."""

    theta: Angles
    wrist: Vector
    elbow: Vector
    farthest: float  # rad: a joint that would move more should look for another way


class Reached(NamedTuple):
    """Joint angles, the passes that they took, and what was wrong with the goal, if anything."""

    theta: Angles
    passes: int
    reason: str


def reach_position(arm: CanonicalArm, target: Vector, start: Start, most: int) -> Reached:
    """Bring the tip to a target (m), the tool's direction being free."""
    passes = 0
    x, y, z = target
    if x * x + y * y + z * z <= arm.reach * arm.reach:
        theta, passes = _iterate(arm, target, start, most)
        if theta is not None:
            return Reached(theta, passes, "")
        for wrist, elbow in _planar_starts(arm, target, start.theta):
            again = Start(start.theta, wrist, elbow, inf)
            theta, used = _iterate(arm, target, again, 1)
            passes += used
            if theta is not None:
                return Reached(theta, passes, "")
    upper, fore, tool = nearest_links(arm, target, start.theta)
    angles = joint_angles(upper, fore, tool, None, start.theta)
    theta = nearest_branch(arm, angles, start.theta, False)
    return Reached(theta, passes, OUT_OF_REACH) if theta else Reached(start.theta, passes, BLOCKED)


def reach_wrist(arm: CanonicalArm, goal: Goal, start: Start, most: int) -> Reached:
    """Bring the tip to the goal's position with the goal's direction, and its roll where given."""
    wrist = subtract(goal.position, scale(goal.tool, arm.tool))
    distance = length(wrist)
    held = min(max(distance, arm.nearest), arm.farthest)
    reason = "" if abs(held - distance) <= _SLACK else OUT_OF_REACH
    if reason and distance > _SLACK:
        wrist = scale(wrist, held / distance)
    theta = close(arm, wrist, goal.tool, goal.roll, start.elbow, start.theta, start.farthest)
    if theta is not None:
        return Reached(theta, 1, reason)
    if goal.roll:
        theta = close(arm, wrist, goal.tool, None, start.elbow, start.theta)
        if theta is not None:
            return Reached(_rolled(arm, theta, goal), 1, reason or ROLL_BLOCKED)
    wrist, elbow = settle(arm, wrist, start.elbow, goal.tool, most)
    theta = close(arm, wrist, goal.tool, None, elbow, start.theta)
    if theta is None:
        return Reached(start.theta, most, BLOCKED)
    return Reached(_rolled(arm, theta, goal) if goal.roll else theta, most, OUT_OF_REACH)


def _iterate(
    arm: CanonicalArm, target: Vector, start: Start, most: int
) -> tuple[Angles | None, int]:
    last, wrist, elbow, farthest = start
    for passes in range(1, most + 1):
        reached = backward(arm, target, wrist, elbow)
        if reached is None:
            return None, passes
        wrist, tool = reached
        theta = close(arm, wrist, tool, None, elbow, last, farthest)
        if theta is not None:
            return theta, passes
        wrist, elbow = forward(arm, wrist, elbow)
    return None, most


def _planar_starts(
    arm: CanonicalArm, target: Vector, last: Angles
) -> Iterator[tuple[Vector, Vector]]:
    """Yield wrists and elbows in the plane of the target and the first axis.

    Near the edge of its reach the arm lies almost in that plane, where passes from elsewhere
    converge slowly.
    """
    x, y, z = target
    beside = hypot(x, y)
    pan = atan2(y, x) if beside > _SLACK else last[0]
    c, s = cos(pan), sin(pan)
    largest = tilt_range(*arm.limits[1])[1]
    for part in (1.0, -1.0, 0.6, -0.6, 0.2, -0.2):
        tilt = part * largest
        r, h = arm.upper * sin(tilt), arm.upper * cos(tilt)
        along_r, along_h = beside - r, z - h
        square = along_r * along_r + along_h * along_h
        part_along = (square + arm.fore**2 - arm.tool**2) / (2.0 * square)
        across = arm.fore**2 / square - part_along**2
        if across < 0.0:
            continue
        for side in (sqrt(across), -sqrt(across)):
            wrist_r = r + part_along * along_r + side * along_h
            wrist_h = h + part_along * along_h - side * along_r
            yield (c * wrist_r, s * wrist_r, wrist_h), (c * r, s * r, h)


def _rolled(arm: CanonicalArm, theta: Angles, goal: Goal) -> Angles:
    """Return θ with the last joint turned as near to the goal's roll as its limits allow."""
    axis = chain(theta)[5]
    x, y = goal.roll
    wanted = atan2(dot(axis, x), dot(axis, y))
    fitted = fit(wanted, theta[6], arm.limits[6])
    if fitted is None:
        fitted = min(arm.limits[6], key=lambda limit: abs(remainder(limit - wanted, TURN)))
    return (*theta[:6], fitted)
