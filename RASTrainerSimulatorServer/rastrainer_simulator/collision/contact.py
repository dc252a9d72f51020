"""The arm's motion in one tick, stopped by what it touches and led along it.

A tick of the simulation is

    moved = contact.move(q, displacement, to_joints)

with `displacement` what the operator wants of the tip (World, m) and `to_joints(displacement)` the
caller's way from an allowed displacement to joint angles: inverse kinematics with the wanted
direction of the tool, then the joints' velocity limit. `moved` holds the new joint angles, where
the links are, all clearances, and what stopped the motion.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rastrainer_simulator.collision.clearance import Clearance
from rastrainer_simulator.collision.collision import Collision
from rastrainer_simulator.collision.sliding import (
    RECOVERY,
    REST,
    HalfSpace,
    Slide,
    nearest_inside,
    slide,
)
from rastrainer_simulator.robot.kinematics import Kinematics
from rastrainer_simulator.vectors import Vector, dot, length, subtract

TOLERANCE = 2e-5
"""Deepest overlap, m, of tip or shaft that is let pass: the next tick takes it back."""

_CORRECTIONS = 3
_SHORTEST_SHARE = 0.05
_CAUTION = 0.9

Joints = tuple[float, ...]
ToJoints = Callable[[Vector], Sequence[float]]


@dataclass(frozen=True)
class Moved:
    """Where a motion ended.

    Attributes:
        q: joint angles, rad.
        link_to_world: (4, 4) float, m, by the names of the links.
        clearance: of this posture.
        stopped_by: "links", "self" or "table" (rarely "tip" or "shaft", at the edge of the arm's
            reach) that cut the motion short, else "". Sliding does not stop a motion.
    """

    q: Joints
    link_to_world: Mapping[str, np.ndarray]
    clearance: Clearance
    stopped_by: str = ""


class Contact:
    """Keeps the arm out of the head, of itself, of the table and of the head's stand.

    Equal calls give equal results: what is cached from the last tick only saves time.
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
        link, the table or the arm itself is in the path, the motion is cut short. What overlaps
        already may move, but not deeper.
        """
        start = self.at(q)
        moved = self._move(start, displacement, to_joints)
        if moved.stopped_by:
            self._last = replace(moved, stopped_by="")
        return moved

    def _move(self, start: Moved, displacement: Vector, to_joints: ToJoints) -> Moved:
        tip = self._tip(start)
        path = self._slide(start, tip, displacement)
        for _ in range(_CORRECTIONS):
            end = self.at(to_joints(subtract(path.position, tip)))
            broken = _broken(start.clearance, end.clearance)
            if broken not in ("tip", "shaft"):
                break
            corrected = _pushed_back(path, start, end, broken)
            if corrected is None:
                break
            path = corrected
        return end if not broken else self._shortened(start, end, broken)

    def _slide(self, start: Moved, tip: Vector, displacement: Vector) -> Slide:
        clearance, reach = start.clearance, length(displacement) + REST
        above = tip[2] - self._collision.table_height
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

    def _shortened(self, start: Moved, end: Moved, broken: str) -> Moved:
        """Return the part of a motion that ends before the overlap, or the start."""
        before = max(_value(start.clearance, broken), 0.0)
        share = _CAUTION * before / (before - _value(end.clearance, broken))
        if share > _SHORTEST_SHARE:
            part = self.at([a + share * (b - a) for a, b in zip(start.q, end.q, strict=True)])
            if not _broken(start.clearance, part.clearance):
                return Moved(part.q, part.link_to_world, part.clearance, broken)
        return Moved(start.q, start.link_to_world, start.clearance, broken)

    def _tip(self, moved: Moved) -> Vector:
        return tuple(moved.link_to_world[self._kinematics.model.tip.name][:3, 3].tolist())


def _broken(start: Clearance, end: Clearance) -> str:
    """Return the first part that overlaps more than it may, "" where none does."""
    if end.tip_m < -TOLERANCE and end.tip_m < start.tip_m:
        return "tip"
    if end.shaft_m < -TOLERANCE and end.shaft_m < start.shaft_m:
        return "shaft"
    if end.links_m < 0.0 and end.links_m < start.links_m:
        return "links"
    if end.self_m < 0.0 and end.self_m < start.self_m:
        return "self"
    if end.table_m < 0.0 and end.table_m < start.table_m:
        return "table"
    return ""


def _value(clearance: Clearance, part: str) -> float:
    return getattr(clearance, f"{part}_m")


def _pushed_back(path: Slide, start: Moved, end: Moved, broken: str) -> Slide | None:
    """Return the path with the overlap at its end undone, None if that is impossible."""
    nearest = end.clearance.tip if broken == "tip" else end.clearance.shaft
    assert nearest is not None, "what is broken was measured"
    gap = min(REST, _value(start.clearance, broken) + RECOVERY) - nearest.distance_m
    planes = (*path.half_spaces, _shifted(nearest.normal, gap, path.position))
    position = nearest_inside(path.position, planes)
    return None if position is None else Slide(position, planes)


def _shifted(normal: Vector, gap: float, position: Vector) -> HalfSpace:
    """Return the half-space that starts `gap` beyond a position along a normal."""
    return HalfSpace(normal, dot(normal, position) + gap)
