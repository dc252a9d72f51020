"""Where the arm gets nearest to a position that it cannot reach.

There every link lies in the plane of the position and the first axis: each link is extreme in its
cone, as seen along the line from the tip to the position, and cones about directions of a plane
have their extremes in that plane. What is left is a planar arm of three joints, each at an end of
its range or free; where one is free, it lies on that line. There are few such postures.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from itertools import accumulate, pairwise, product
from math import atan2, cos, hypot, pi, remainder, sin
from typing import NamedTuple

from rastrainer_simulator.robot.branches import TURN
from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm, tilt_range
from rastrainer_simulator.vectors import Vector

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
