"""Bring the chain to a goal by FABRIK's passes and the exact closure, or as near as it gets."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from itertools import accumulate, pairwise, product
from math import atan2, cos, dist, hypot, inf, pi, remainder, sin, sqrt
from typing import NamedTuple

from rastrainer_simulator.robot.branches import TURN, fit, joint_angles, nearest_branch
from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm, chain, tilt_range
from rastrainer_simulator.robot.elbow_circle import elbow_circle
from rastrainer_simulator.robot.elbow_slide import close, with_least_motion
from rastrainer_simulator.robot.fabrik_passes import backward, forward, settle
from rastrainer_simulator.robot.goal import Goal
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


_SLACK = 1e-12
# Beside and above the shoulder, m.
Point = tuple[float, float]
# Each link's angle from the first axis, rad.
Posture = tuple[float, ...]


class RigidPart(NamedTuple):
    """The links from one free joint to the next: their angles, and the line between the joints."""

    angles: Posture
    chord: float
    chord_angle: float


class ReachPlan(NamedTuple):
    """The fixed links before the first free joint, and the rigid parts from there on."""

    fixed: Posture
    start: Point
    parts: tuple[RigidPart, ...]


def nearest_links(arm: CanonicalArm, target: Vector, last: Angles) -> tuple[Vector, Vector, Vector]:
    """Return the directions of upper arm, forearm and tool that bring the tip nearest to `target`.

    `target` (m) is out of reach; where it is on the first axis, the arm stays in its plane of
    `last`.

    There every link lies in the plane of the target and the first axis: each link is extreme in
    its cone, as seen along the line from the tip to the target, and cones about directions of a
    plane have their extremes in that plane. What is left is a planar arm of three joints, each at
    an end of its range or free; where one is free, it lies on that line. There are few such
    postures.
    """
    x, y, z = target
    beside = hypot(x, y)
    pan = atan2(y, x) if beside > 1e-9 else last[0]
    plans = _plans(arm)
    # Nearest to a target that is too far away is the stretched arm: every joint free.
    posture = _posture(plans[0], (1, 1, 1), beside, z)
    if hypot(beside, z) < arm.reach or not _allowed(arm, posture):
        candidates = []
        for number, plan in enumerate(plans):
            candidates += [(off, number, signs) for off, signs in _distances(plan, beside, z)]
        postures = (_posture(plans[n], signs, beside, z) for _, n, signs in sorted(candidates))
        posture = next(posture for posture in postures if _allowed(arm, posture))
    c, s = cos(pan), sin(pan)
    upper, fore, tool = ((c * sin(angle), s * sin(angle), cos(angle)) for angle in posture)
    return upper, fore, tool


@lru_cache(maxsize=8)
def _plans(arm: CanonicalArm) -> tuple[ReachPlan, ...]:
    """Return a plan for every choice of free joints and of ends for the others."""
    lengths = (arm.upper, arm.fore, arm.tool)
    ends: list[tuple[float | None, ...]] = []
    for joint in (1, 3, 5):
        smallest, largest = tilt_range(*arm.limits[joint])
        ends.append((None, *sorted({-largest, -smallest, smallest, largest} - {0.0})))
    plans = []
    for choice in product(*ends):
        free = [joint for joint, tilt in enumerate(choice) if tilt is None]
        tilts = [0.0 if tilt is None else tilt for tilt in choice]
        fixed = tuple(accumulate(tilts[: free[0]] if free else tilts))
        parts = []
        for first, after in pairwise([*free, 3]):
            angles = tuple(accumulate(tilts[first + 1 : after], initial=0.0))
            across, along = _end(lengths[first:after], angles)
            parts.append(RigidPart(angles, hypot(across, along), atan2(across, along)))
        plans.append(ReachPlan(fixed, _end(lengths, fixed), tuple(parts)))
    return tuple(plans)


def _distances(
    plan: ReachPlan, beside: float, above: float
) -> Iterator[tuple[float, tuple[int, ...]]]:
    """Yield how near the tip gets with the chords pointing to the target (1) or away (−1).

    From each free joint the tip has to be on the target's side: turned by π it would be nearer.
    """
    distance = hypot(beside - plan.start[0], above - plan.start[1])
    for signs in product((1, -1), repeat=len(plan.parts)):
        joints = [0.0]
        for sign, part in zip(signs, plan.parts, strict=True):
            joints.append(joints[-1] + sign * part.chord)
        tip = joints.pop()
        if all((tip - joint) * (distance - joint) >= 0.0 for joint in joints):
            yield abs(distance - tip), signs


def _posture(plan: ReachPlan, signs: tuple[int, ...], beside: float, above: float) -> Posture:
    aim = atan2(beside - plan.start[0], above - plan.start[1])
    posture = list(plan.fixed)
    for sign, part in zip(signs, plan.parts, strict=True):
        first = (aim if sign > 0 else aim + pi) - part.chord_angle
        posture += [first + angle for angle in part.angles]
    return tuple(posture)


def _end(lengths: tuple[float, ...], posture: Posture) -> Point:
    pairs = list(zip(lengths, posture, strict=False))
    return sum(a * sin(angle) for a, angle in pairs), sum(a * cos(angle) for a, angle in pairs)


def _allowed(arm: CanonicalArm, posture: Posture) -> bool:
    before = 0.0
    for angle, joint in zip(posture, (1, 3, 5), strict=True):
        smallest, largest = tilt_range(*arm.limits[joint])
        if not smallest - _SLACK <= abs(remainder(angle - before, TURN)) <= largest + _SLACK:
            return False
        before = angle
    return True
