"""Bring the chain to a goal by FABRIK's passes and the exact closure, or as near as it gets."""

from __future__ import annotations

from collections.abc import Iterator
from math import atan2, cos, dist, hypot, inf, remainder, sin, sqrt
from typing import NamedTuple

from rastrainer_simulator.robot.branches import TURN, fit, joint_angles, nearest_branch
from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm, chain, tilt_range
from rastrainer_simulator.robot.closure import close
from rastrainer_simulator.robot.elbow_circle import elbow_circle
from rastrainer_simulator.robot.elbow_slide import with_least_motion
from rastrainer_simulator.robot.fabrik_passes import backward, forward, settle
from rastrainer_simulator.robot.goal import Goal
from rastrainer_simulator.robot.nearest_reach import nearest_links
from rastrainer_simulator.vectors import Vector, dot

# Passes that change the gap between them by less than this share of it do not converge.
_STALLED = 1e-3


class Start(NamedTuple):
    """Where FABRIK starts: joint angles with their wrist and elbow (m)."""

    theta: Angles
    wrist: Vector
    elbow: Vector
    farthest: float  # rad: a joint that would move more calls for another solution


class Reached(NamedTuple):
    """Joint angles, the passes that they took, and whether the limits allowed no better ones."""

    theta: Angles
    passes: int
    blocked: bool = False


def reach_position(arm: CanonicalArm, goal: Goal, aim: Goal, start: Start, most: int) -> Reached:
    """Bring the tip to a goal, or as near as it gets, the tool's direction being free.

    `aim` is the goal, moved to where the arm's lengths allow it.
    """
    target = aim.position
    theta, passes = _iterate(arm, target, start, most)
    if theta is not None:
        return Reached(theta, passes)
    for wrist, elbow in planar_starts(arm, target, start.theta):
        theta, used = _iterate(arm, target, Start(start.theta, wrist, elbow, inf), 1)
        passes += used
        if theta is not None:
            return Reached(theta, passes)
    upper, fore, tool = nearest_links(arm, goal.position, start.theta)
    angles = joint_angles(upper, fore, tool, None, start.theta)
    theta = nearest_branch(arm, angles, start.theta, False)
    return Reached(theta, passes) if theta else Reached(start.theta, passes, True)


def reach_wrist(arm: CanonicalArm, goal: Goal, aim: Goal, start: Start, most: int) -> Reached:
    """Bring the tip to a goal with the tool's direction, and its roll where given.

    `aim` is as in `reach_position`. Where the limits do not allow it, the roll is given up first,
    then the position.
    """
    wrist, tool = aim.wrist(arm), goal.held_tool
    circle = elbow_circle(arm, wrist, start.elbow)
    theta = close(arm, circle, wrist, tool, goal.roll, start.theta, start.farthest)
    if theta is not None:
        if start.farthest < inf:
            theta = with_least_motion(arm, theta, circle, wrist, goal, start.theta)
        return Reached(theta, 1)
    passes = 1
    if goal.roll:
        theta = close(arm, circle, wrist, tool, None, start.theta)
    if theta is None:
        passes += most
        wrist, elbow = settle(arm, goal.wrist(arm), start.elbow, tool, most)
        theta = close(arm, elbow_circle(arm, wrist, elbow), wrist, tool, None, start.theta)
    if theta is None:
        return Reached(start.theta, passes, True)
    return Reached(_rolled(arm, theta, goal.roll) if goal.roll else theta, passes)


def _iterate(
    arm: CanonicalArm, target: Vector, start: Start, most: int
) -> tuple[Angles | None, int]:
    last, wrist, elbow, farthest = start
    gap = inf
    for passes in range(1, most + 1):
        reached = backward(arm, target, wrist, elbow)
        if reached is None:
            return None, passes
        held, tool = reached
        circle = elbow_circle(arm, held, elbow)
        theta = close(arm, circle, held, tool, None, last, farthest)
        if theta is not None:
            return theta, passes
        wrist, elbow = forward(arm, held, elbow)
        before, gap = gap, dist(wrist, held)
        if abs(before - gap) < _STALLED * gap:
            return None, passes
    return None, most


def _rolled(arm: CanonicalArm, theta: Angles, roll: tuple[Vector, Vector]) -> Angles:
    """Return θ with the last joint turned as near to a roll as its limits allow."""
    axis = chain(theta)[5]
    x, y = roll
    wanted = atan2(dot(axis, x), dot(axis, y))
    fitted = fit(wanted, theta[6], arm.limits[6])
    if fitted is None:
        fitted = min(arm.limits[6], key=lambda limit: abs(remainder(limit - wanted, TURN)))
    return (*theta[:6], fitted)


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
