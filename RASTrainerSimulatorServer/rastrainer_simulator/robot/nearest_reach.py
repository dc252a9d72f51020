"""Where the arm gets nearest to a position that it cannot reach.

There every link lies in the plane of the position and the first axis: each link is extreme in its
cone, as seen along the line from the tip to the position, and cones about directions of a plane
have their extremes in that plane. What is left is a planar arm of three joints, each at an end of
its range or free; where one is free, it lies on that line. There are few such postures.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import atan2, cos, dist, hypot, pi, remainder, sin

from rastrainer_simulator.robot.branches import TURN
from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm, tilt_range
from rastrainer_simulator.vectors import Vector

_SLACK = 1e-12
Point = tuple[float, float]


def nearest_links(arm: CanonicalArm, target: Vector, last: Angles) -> list[Vector]:
    """Return the directions of upper arm, forearm and tool that bring the tip nearest to `target`.

    `target` (m) is out of reach; where it is on the first axis, the arm stays in its plane of
    `last`.
    """
    x, y, z = target
    beside = hypot(x, y)
    pan = atan2(y, x) if beside > 1e-9 else last[0]
    lengths = (arm.upper, arm.fore, arm.tool)
    tilts = [tilt_range(*arm.limits[joint]) for joint in (1, 3, 5)]
    straight = atan2(beside, z)
    if hypot(beside, z) >= sum(lengths) and _allowed((straight,) * 3, tilts):
        best = (straight,) * 3
    else:
        best = min(
            _postures(lengths, tilts, (beside, z)),
            key=lambda posture: dist(_end(lengths, posture), (beside, z)),
        )
    c, s = cos(pan), sin(pan)
    return [(c * sin(angle), s * sin(angle), cos(angle)) for angle in best]


def _postures(
    lengths: tuple[float, ...], tilts: list[tuple[float, float]], target: Point
) -> Iterator[tuple[float, ...]]:
    """Yield the allowed postures in question: each link's angle from the vertical."""
    ends = [{-largest, -smallest, smallest, largest} - {0.0, -0.0} for smallest, largest in tilts]
    for choice in product(*[(None, *sorted(values)) for values in ends]):
        free = [joint for joint, tilt in enumerate(choice) if tilt is None]
        for signs in product((0.0, pi), repeat=len(free)):
            posture = _aimed(lengths, choice, dict(zip(free, signs, strict=True)), target)
            if _allowed(posture, tilts):
                yield posture


def _aimed(
    lengths: tuple[float, ...],
    choice: tuple[float | None, ...],
    reversed_by: dict[int, float],
    target: Point,
) -> tuple[float, ...]:
    """Return the posture with the tilts of `choice` and the free joints in line with `target`.

    From one free joint to the next the arm is rigid; its chord points to the target, or away.
    """
    posture: list[float] = []
    aim = None
    for joint, tilt in enumerate(choice):
        before = posture[-1] if posture else 0.0
        if tilt is not None:
            posture.append(before + tilt)
            continue
        if aim is None:
            start = _end(lengths, posture)
            aim = atan2(target[0] - start[0], target[1] - start[1])
        rigid = [0.0]
        for following in choice[joint + 1 :]:
            if following is None:
                break
            rigid.append(rigid[-1] + following)
        chord = _end(lengths[joint:], rigid)
        posture.append(aim + reversed_by[joint] - atan2(*chord))
    return tuple(posture)


def _end(lengths: tuple[float, ...], posture: list[float] | tuple[float, ...]) -> Point:
    """Return the end of the links whose angles are given: beside and above the start."""
    pairs = list(zip(lengths, posture, strict=False))
    return sum(a * sin(angle) for a, angle in pairs), sum(a * cos(angle) for a, angle in pairs)


def _allowed(posture: tuple[float, ...], tilts: list[tuple[float, float]]) -> bool:
    before = 0.0
    for angle, (smallest, largest) in zip(posture, tilts, strict=True):
        if not smallest - _SLACK <= abs(remainder(angle - before, TURN)) <= largest + _SLACK:
            return False
        before = angle
    return True
