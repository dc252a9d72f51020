"""Bring the chain to a goal by FABRIK's passes and the exact closure, or as near as it gets.

Aristidou & Lasenby 2011 (10.1016/j.gmod.2011.05.003): reach backward from the target, then forward
from the base, each time moving a joint along the line to its neighbor to the link's length, within
the joints' cones. The passes need not be iterated for the elbow: both keep it in the half-plane
through the line from shoulder to wrist, so their limit is the nearest point of the elbow's circle,
which `closure` gives exactly. Only the wrist is left to iterate.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from itertools import accumulate, pairwise, product
from math import atan2, cos, dist, hypot, inf, pi, remainder, sin, sqrt
from typing import NamedTuple

from rastrainer_simulator.robot.closure import TURN, elbow_circle, fit, joint_angles, nearest_branch
from rastrainer_simulator.robot.elbow_slide import close, with_least_motion
from rastrainer_simulator.robot.goal import Goal
from rastrainer_simulator.robot.srs_arm import Angles, CanonicalArm, chain, tilt_range
from rastrainer_simulator.vectors import Vector, any_perpendicular, dot, scale, subtract

# Passes that change the gap between them by less than this share of it do not converge.
_STALLED = 1e-3


class Start(NamedTuple):
    """Where FABRIK starts: joint angles with their wrist and elbow (m)."""

    theta: Angles
    wrist: Vector
    elbow: Vector
    farthest: float  # rad: a joint that would move more calls for another solution


def reach_position(
    arm: CanonicalArm, goal: Goal, aim: Goal, start: Start, most: int
) -> Angles | None:
    """Bring the tip to a goal, or as near as it gets, the tool's direction being free.

    `aim` is the goal, moved to where the arm's lengths allow it. At most `most` passes are tried.
    None if the limits allow nothing better than the start.
    """
    target = aim.position
    theta = _iterate(arm, target, start, most)
    if theta is not None:
        return theta
    for wrist, elbow in _planar_starts(arm, target, start.theta):
        theta = _iterate(arm, target, Start(start.theta, wrist, elbow, inf), 1)
        if theta is not None:
            return theta
    upper, fore, tool = _nearest_links(arm, goal.position, start.theta)
    angles = joint_angles(upper, fore, tool, None, start.theta)
    return nearest_branch(arm, angles, start.theta, False)


def reach_wrist(arm: CanonicalArm, goal: Goal, aim: Goal, start: Start, most: int) -> Angles | None:
    """Bring the tip to a goal with the tool's direction, and its roll where given.

    The arguments are as in `reach_position`. If the limits do not allow the goal, the roll is given
    up first, then the position.
    """
    wrist, tool = aim.wrist(arm), goal.held_tool
    circle = elbow_circle(arm, wrist, start.elbow)
    theta = close(arm, circle, wrist, tool, goal.roll, start.theta, start.farthest)
    if theta is not None:
        if start.farthest < inf:
            theta = with_least_motion(arm, theta, circle, wrist, goal, start.theta)
        return theta
    if goal.roll:
        theta = close(arm, circle, wrist, tool, None, start.theta)
    if theta is None:
        wrist, elbow = settle(arm, goal.wrist(arm), start.elbow, tool, most)
        theta = close(arm, elbow_circle(arm, wrist, elbow), wrist, tool, None, start.theta)
    if theta is not None and goal.roll:
        # The last joint is turned as near to the roll as its limits allow.
        axis = chain(theta)[5]
        x, y = goal.roll
        wanted = atan2(dot(axis, x), dot(axis, y))
        fitted = fit(wanted, theta[6], arm.limits[6])
        if fitted is None:
            fitted = min(arm.limits[6], key=lambda limit: abs(remainder(limit - wanted, TURN)))
        theta = (*theta[:6], fitted)
    return theta


def _iterate(arm: CanonicalArm, target: Vector, start: Start, most: int) -> Angles | None:
    last, wrist, elbow, farthest = start
    gap = inf
    for _ in range(most):
        reached = backward(arm, target, wrist, elbow)
        if reached is None:
            return None
        held, tool = reached
        circle = elbow_circle(arm, held, elbow)
        theta = close(arm, circle, held, tool, None, last, farthest)
        if theta is not None:
            return theta
        wrist, elbow = forward(arm, held, elbow)
        before, gap = gap, dist(wrist, held)
        if abs(before - gap) < _STALLED * gap:
            return None
    return None


_TINY = 1e-12


def _planar_starts(
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
        # Where the wrist can be, from the elbow, if the target is at (dr, dh) from it.
        dr, dh = beside - r, z - h
        square = dr * dr + dh * dh
        if square < _TINY:
            continue
        along = (square + arm.fore * arm.fore - arm.tool * arm.tool) / (2.0 * square)
        across = arm.fore * arm.fore / square - along * along
        for side in (sqrt(across), -sqrt(across)) if across >= 0.0 else ():
            out, up = r + (along * dr + side * dh), h + (along * dh - side * dr)
            yield (c * out, s * out, up), (c * r, s * r, h)


_SLACK = 1e-12
# Horizontal and vertical distance from the shoulder, m.
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


def _nearest_links(
    arm: CanonicalArm, target: Vector, last: Angles
) -> tuple[Vector, Vector, Vector]:
    """Return the directions of upper arm, forearm and tool that bring the tip nearest to `target`.

    `target` (m) is out of reach; where it is on the first axis, the arm stays in its plane of
    `last`.

    Every link is then in the plane of the target and the first axis: each link is extreme in its
    cone, as seen along the line from the tip to the target, and cones about directions of a plane
    have their extremes in that plane. A planar arm of three joints remains, each at an end of its
    range, or free and on that line. There are few such postures.
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

    The tip has to be on the target's side of each free joint: turned by π it would be nearer.
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


_SHOULDER = (0.0, 0.0, 0.0)
_UP = (0.0, 0.0, 1.0)
_ROUNDING = 1e-15
_SETTLED = 1e-6


def backward(
    arm: CanonicalArm, target: Vector, wrist: Vector, elbow: Vector
) -> tuple[Vector, Vector] | None:
    """Reach from the target back to the wrist; return the wrist and the tool's direction.

    The tool stays in its cone about the forearm, the wrist in the band that the elbow's tilt
    leaves it. None if no wrist in the band is a tool's length from the target.
    """
    tool = _inside(_toward(wrist, target), _toward(elbow, wrist), arm.wrist_cosines)
    wx, wy, wz = subtract(target, scale(tool, arm.tool))
    square = wx * wx + wy * wy + wz * wz
    if arm.nearest * arm.nearest <= square <= arm.farthest * arm.farthest:
        return (wx, wy, wz), tool
    bound = arm.nearest if square < arm.nearest * arm.nearest else arm.farthest
    return _at_distance(arm, target, (wx, wy, wz), bound)


def forward(arm: CanonicalArm, wrist: Vector, elbow: Vector) -> tuple[Vector, Vector]:
    """Reach from the shoulder to the wrist inside the cones; return wrist and elbow."""
    upper = _inside(_toward(_SHOULDER, elbow), _UP, arm.shoulder_cosines)
    elbow = subtract(_SHOULDER, scale(upper, -arm.upper))
    fore = _inside(_toward(elbow, wrist), upper, arm.elbow_cosines)
    return subtract(elbow, scale(fore, -arm.fore)), elbow


def settle(
    arm: CanonicalArm, wrist: Vector, elbow: Vector, tool: Vector, passes: int
) -> tuple[Vector, Vector]:
    """Iterate both passes toward a wrist that cannot be reached, the tool's direction being held.

    Return the wrist and elbow that come nearest.
    """
    wanted = wrist
    for _ in range(passes):
        before = wrist
        fore = _inside(_toward(elbow, wanted), tool, arm.wrist_cosines)
        wrist, elbow = forward(arm, wanted, subtract(wanted, scale(fore, arm.fore)))
        fore = _inside(_toward(elbow, wrist), tool, arm.wrist_cosines)
        wrist = subtract(elbow, scale(fore, -arm.fore))
        if dist(before, wrist) < _SETTLED:
            break
    return wrist, elbow


def _at_distance(
    arm: CanonicalArm, target: Vector, wrist: Vector, distance: float
) -> tuple[Vector, Vector] | None:
    """Return the wrist nearest to `wrist` at that distance (m) from the shoulder, with its tool."""
    px, py, pz = target
    reach = sqrt(px * px + py * py + pz * pz)
    if reach < _TINY:
        return None
    ax, ay, az = px / reach, py / reach, pz / reach
    along = (reach * reach + distance * distance - arm.tool * arm.tool) / (2.0 * reach)
    square = distance * distance - along * along
    if square < -_ROUNDING:
        return None
    # A remainder of the size of a rounding error has no direction.
    square = square if square > _ROUNDING else 0.0
    part = wrist[0] * ax + wrist[1] * ay + wrist[2] * az
    bx, by, bz = wrist[0] - part * ax, wrist[1] - part * ay, wrist[2] - part * az
    size = sqrt(bx * bx + by * by + bz * bz)
    if size < _TINY:
        (bx, by, bz), size = any_perpendicular((ax, ay, az)), 1.0
    beside = sqrt(square) / size
    wx, wy, wz = along * ax + beside * bx, along * ay + beside * by, along * az + beside * bz
    return (wx, wy, wz), _toward((wx, wy, wz), target)


def _toward(start: Vector, end: Vector) -> Vector:
    x, y, z = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    size = sqrt(x * x + y * y + z * z)
    return (x / size, y / size, z / size) if size > _TINY else _UP


def _inside(direction: Vector, axis: Vector, cosines: tuple[float, float]) -> Vector:
    """Return `direction`, turned into its cone about `axis` where it is outside."""
    cosine = direction[0] * axis[0] + direction[1] * axis[1] + direction[2] * axis[2]
    low, high = cosines
    if low <= cosine <= high:
        return direction
    bound = low if cosine < low else high
    x = direction[0] - cosine * axis[0]
    y = direction[1] - cosine * axis[1]
    z = direction[2] - cosine * axis[2]
    size = sqrt(x * x + y * y + z * z)
    if size < _TINY:
        (x, y, z), size = any_perpendicular(axis), 1.0
    sine = sqrt(max(0.0, 1.0 - bound * bound)) / size
    return (bound * axis[0] + sine * x, bound * axis[1] + sine * y, bound * axis[2] + sine * z)
