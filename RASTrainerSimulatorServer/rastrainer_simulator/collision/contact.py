"""The arm's motion in one tick: obstacles stop it, and surfaces lead it along.

A tick of the simulation is

    moved = contact.move(q, displacement, to_joints)

with `displacement` what the operator wants of the tip (World, m) and `to_joints(displacement)` the
caller's conversion of an allowed displacement to joint angles: inverse kinematics with the wanted
direction of the tool, then the joints' velocity limit. `moved` holds the new joint angles, where
the links are, all clearances, and what stopped the motion. The tip goes up to the surface and
along it, never behind a plane of contact.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from rastrainer_simulator.collision.clearance import Clearance
from rastrainer_simulator.collision.collision import Collision
from rastrainer_simulator.collision.head_surface import Nearest
from rastrainer_simulator.robot.kinematics import Kinematics
from rastrainer_simulator.vectors import (
    Vector,
    add,
    cross,
    distance,
    dot,
    length,
    scale,
    shortened,
    subtract,
)

TOLERANCE = 2e-5
"""Deepest overlap, m, of tip or shaft that is tolerated: the next tick undoes it."""
_PARTS = (
    *(("tip", "tip_m", -TOLERANCE), ("shaft", "shaft_m", -TOLERANCE)),
    *(("links", "links_m", 0.0), ("self", "self_m", 0.0), ("table", "table_m", 0.0)),
)

_CORRECTIONS = 3
_SHORTEST_SHARE = 0.05
_CAUTION = 0.9

Joints = tuple[float, ...]
ToJoints = Callable[[Vector], Sequence[float]]


@dataclass(frozen=True)
class Moved:
    """Where a motion ended.

    `link_to_world` are (4, 4) float, m, by the names of the links. "links", "self" or "table"
    (rarely "tip" or "shaft", at the edge of the arm's reach) cut a motion short: `stopped_by`.
    """

    q: Joints
    link_to_world: Mapping[str, np.ndarray]
    clearance: Clearance
    stopped_by: str = ""


class Contact:
    """Keeps the arm from entering the head, itself, the table and the head's stand.

    Equal calls give equal results: values cached from the last tick only save time.
    """

    def __init__(self, collision: Collision, kinematics: Kinematics) -> None:
        self._collision = collision
        self._kinematics = kinematics
        self._last: Moved | None = None

    def head_has_moved(self) -> None:
        """Forget the last posture's clearances; to be called after `Collision.set_head_pose`."""
        self._last = None

    def at(self, q: Sequence[float]) -> Moved:
        """Return the links and clearances of a posture, wherever it may be."""
        joints = tuple(map(float, q))
        if self._last is None or self._last.q != joints:
            links = self._kinematics.links(joints)
            self._last = Moved(joints, links, self._collision.check(links))
        return self._last

    def move(self, q: Sequence[float], displacement: Vector, to_joints: ToJoints) -> Moved:
        """Return where a motion from `q` ends that is to move the tip by `displacement`.

        The tip stops 0.01 mm above the head and slides along it, and so does the shaft. Where a
        link, the table or the arm itself is in the path, the motion is cut short. Overlapping
        parts may move, but not deeper.
        """
        start = self.at(q)
        tip = tuple(start.link_to_world[self._kinematics.model.tip.name][:3, 3].tolist())
        path = self._slide(start, tip, displacement)
        for _ in range(_CORRECTIONS):
            end = self.at(to_joints(subtract(path.position, tip)))
            broken = _broken(start.clearance, end.clearance)
            if broken not in ("tip", "shaft"):
                break
            nearest = end.clearance.tip if broken == "tip" else end.clearance.shaft
            assert nearest is not None, "what is broken was measured"
            gap = min(REST, getattr(start.clearance, f"{broken}_m") + RECOVERY) - nearest.distance_m
            planes = (*path.half_spaces, _shifted(nearest.normal, gap, path.position))
            position = nearest_inside(path.position, planes)
            if position is None:
                break
            path = Slide(position, planes)
        if not broken:
            return end
        # The part of the motion that ends before the overlap, or the start.
        before = max(getattr(start.clearance, f"{broken}_m"), 0.0)
        share = _CAUTION * before / (before - getattr(end.clearance, f"{broken}_m"))
        part = start
        if share > _SHORTEST_SHARE:
            part = self.at([a + share * (b - a) for a, b in zip(start.q, end.q, strict=True)])
            if _broken(start.clearance, part.clearance):
                part = start
        self._last = part
        return replace(part, stopped_by=broken)

    def _slide(self, start: Moved, tip: Vector, displacement: Vector) -> Slide:
        clearance, reach = start.clearance, length(displacement) + REST
        above = tip[2]
        others = []
        shaft = clearance.shaft
        if shaft is None and clearance.shaft_m < reach:
            shaft = self._collision.nearest_to_shaft(start.link_to_world, reach)
        if shaft is not None and shaft.distance_m < reach:
            gap = min(REST - shaft.distance_m, RECOVERY)
            others.append(_shifted(shaft.normal, gap, tip))
        if above < reach:
            others.append(_shifted((0.0, 0.0, 1.0), min(REST - above, RECOVERY), tip))
        return slide(self._collision.nearest_to_point, tip, clearance.tip, displacement, others)


def _broken(start: Clearance, end: Clearance) -> str:
    """Return the first part that overlaps more than it may, "" where none does."""
    for part, clearance, tolerated in _PARTS:
        now = getattr(end, clearance)
        if now < tolerated and now < getattr(start, clearance):
            return part
    return ""


def _shifted(normal: Vector, gap: float, position: Vector) -> HalfSpace:
    return HalfSpace(normal, dot(normal, position) + gap)


_INSIDE = 1e-10
_PARALLEL = 1e-9


class HalfSpace(NamedTuple):
    """All points x with normal · x ≥ bound; the normal is a unit vector."""

    normal: Vector
    bound: float


def nearest_inside(goal: Vector, half_spaces: Sequence[HalfSpace]) -> Vector | None:
    """Return the point in all half-spaces that is nearest to `goal`, None if there is none.

    It lies on none, one, two or three of the planes, and is the nearest of the feasible points
    found by trying them all: with the handful of planes of a contact that takes microseconds.
    """
    if _is_inside(goal, half_spaces):
        return goal
    feasible = [point for point in _candidates(goal, half_spaces) if _is_inside(point, half_spaces)]
    return min(feasible, key=lambda point: distance(point, goal), default=None)


def _is_inside(point: Vector, half_spaces: Sequence[HalfSpace]) -> bool:
    return all(dot(normal, point) >= bound - _INSIDE for normal, bound in half_spaces)


def _candidates(goal: Vector, half_spaces: Sequence[HalfSpace]) -> Iterator[Vector]:
    for normal, bound in half_spaces:
        yield add(goal, scale(normal, bound - dot(normal, goal)))
    for first, second in combinations(half_spaces, 2):
        along = dot(first.normal, second.normal)
        sine_squared = 1.0 - along * along
        if sine_squared < _PARALLEL:
            continue
        a = first.bound - dot(first.normal, goal)
        b = second.bound - dot(second.normal, goal)
        share_1, share_2 = (a - along * b) / sine_squared, (b - along * a) / sine_squared
        yield add(goal, add(scale(first.normal, share_1), scale(second.normal, share_2)))
    for first, second, third in combinations(half_spaces, 3):
        across = cross(second.normal, third.normal)
        volume = dot(first.normal, across)
        if abs(volume) < _PARALLEL:
            continue
        corner = add(
            scale(across, first.bound),
            add(
                scale(cross(third.normal, first.normal), second.bound),
                scale(cross(first.normal, second.normal), third.bound),
            ),
        )
        yield scale(corner, 1.0 / volume)


REST = 1e-5
"""Clearance, m, at which a pressed tip rests: it never crosses, yet counts as touching."""

LONGEST_STEP = 5e-4
"""The tip passes near surfaces in steps, m, so short that it cannot jump through an ear."""

RECOVERY = 2e-4
"""How far, m a tick, a tip that is inside (the head was put there) is moved toward the outside."""

_TRIALS = 5
_STANDSTILL = 1e-9
_EXACT = 1e-8


class Slide(NamedTuple):
    """Where the tip may go, and the planes (World) that limit it there."""

    position: Vector
    half_spaces: tuple[HalfSpace, ...]


def slide(
    nearest_to_point: Callable[[Vector], Nearest],
    tip: Vector,
    here: Nearest,
    displacement: Vector,
    others: Sequence[HalfSpace],
) -> Slide:
    """Return the path of a tip at `tip` (World, m) that is to move by `displacement`.

    `here` is the head's surface nearest to the tip, `others` what limits the tip besides. At each
    step the tip moves toward the point nearest to its goal that is on the free side of the
    surface's tangent planes: at the tip, and wherever a trial ended inside. In a groove two planes
    hold it, in a pit three, so that it comes to rest there instead of jumping from wall to wall
    (the god object of Zilles and Salisbury 1995, 10.1109/IROS.1995.525876).
    """
    goal = add(tip, displacement)
    rest = min(REST, here.distance_m + RECOVERY)
    position, planes = tip, tuple(others)
    for _ in range(math.ceil(length(displacement) / LONGEST_STEP)):
        free = here.distance_m - rest
        if distance(position, goal) <= free:  # Within a ball that holds nothing of the head.
            return Slide(nearest_inside(goal, others) or position, tuple(others))
        planes = (_shifted(here.normal, rest, here.point), *others)
        step = _step(nearest_to_point, position, goal, planes, max(free, LONGEST_STEP), rest)
        if step is None:
            break
        reached, here, planes = step
        moved = distance(position, reached)
        position = reached
        if moved < _STANDSTILL:
            break
    return Slide(position, planes)


def _step(
    nearest_to_point: Callable[[Vector], Nearest],
    position: Vector,
    goal: Vector,
    planes: tuple[HalfSpace, ...],
    longest: float,
    rest: float,
) -> tuple[Vector, Nearest, tuple[HalfSpace, ...]] | None:
    """Return the end of one step toward the goal, the nearest point there, and limiting planes."""
    for _ in range(_TRIALS):
        target = nearest_inside(goal, planes)
        if target is None:
            break
        short = add(position, shortened(subtract(target, position), longest))
        # If the point is nearer than `rest`, a short displacement leads only part of the way out.
        trial = nearest_inside(short, planes) or short
        there = nearest_to_point(trial)
        if there.distance_m >= rest - _EXACT:
            return trial, there, planes
        planes = (*planes, _shifted(there.normal, rest, there.point))
    return None
