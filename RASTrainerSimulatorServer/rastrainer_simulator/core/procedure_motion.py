"""A procedure besides the arm: the head ahead of the guide, the feed, and self-alignment."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from rastrainer.head.mesh import HeadMesh, mesh_crossings, read_head_mesh
from rastrainer.journal.entries import FeedChange
from rastrainer.procedure.checks import planned_bone
from rastrainer.procedure.geometry import BoneAhead, bone_ahead
from rastrainer.protocol import Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.touch_planner import PlanReach
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.state import Event, OperatorInput
from rastrainer_simulator.teleoperation.commanded_motion import FollowingPath
from rastrainer_simulator.texts.texts import LocalizedText, say
from rastrainer_simulator.training.feed import LONGEST_FEED_M, NO_FEED, Feed, FeedDrive, HeadAhead
from rastrainer_simulator.training.head_pose import RegisteredPlan
from rastrainer_simulator.trial_state import GuideAxis, PlannedLine, ProcedureState
from rastrainer_simulator.vectors import (
    Vector,
    add,
    angle,
    distance,
    dot,
    scale,
    subtract,
    turned_toward,
    unit,
    vector,
)

BEHIND_MM = 1.0
"""A tip that rests on the skin may be a little within it: the search begins this far behind it."""

PlannedBone = Mapping[str, tuple[BoneAhead | None, ...]]
"""Where the planned lines of each procedure go through bone, mm from the entry."""


FEED_PHASES = (Phase.DRILLING, Phase.INSERTING)
"""The arm is held, and the instrument in the guide moves."""


class Fed(NamedTuple):
    """The effect of a tick on the instrument in the guide."""

    has_moved: bool = False
    is_by_stick: bool = False
    events: tuple[Event, ...] = ()


NOT_FED = Fed()


class ProcedureMotion:
    """The feed of drill and instrument, and the geometry that a procedure needs of the head."""

    def __init__(self, setup: SimulationSetup, head: HeadMesh, reach: PlanReach) -> None:
        """`head` is the scenario's; without procedures nothing is made of it."""
        settings, scenario = setup.settings, setup.scenario
        self.feed = NO_FEED
        self._may_align = settings.procedure.self_alignment
        self._reach = reach
        self.drive = FeedDrive(settings.procedure, settings.teleoperation.response)
        self.planned_bone: PlannedBone = {}
        if scenario.procedures:
            self._skin, self._skull = head, read_head_mesh(scenario.skull_path)
            # Computed now, not in the tick in which the first guide is locked.
            _ = head.triangle_spheres, self._skull.triangle_spheres
            self.planned_bone = {
                each.name: tuple(planned_bone(line, self._skull) for line in each.trajectories)
                for each in scenario.procedures
            }
            self._outline = HeadOutline(head.vertices, scenario.target.position_ras)

    def reset(self, feed: Feed = NO_FEED) -> None:
        self.feed = feed
        self.drive.stop()

    def ahead(self, guide: GuideAxis, head_to_world: np.ndarray) -> HeadAhead:
        """Return the distances to skin and bone along a guide's axis; all is in m."""
        rotation, shift = head_to_world[:3, :3], head_to_world[:3, 3]
        axis = rotation.T @ np.array(guide.direction)
        tip_mm = MM_PER_M * (rotation.T @ (np.array(guide.tip) - shift))
        line = tip_mm - BEHIND_MM * axis, axis, MM_PER_M * LONGEST_FEED_M + BEHIND_MM
        crossings = mesh_crossings(self._skin, *line)
        bone = bone_ahead(self._skull, *line)
        distances_mm = (
            crossings[0].distance_mm if crossings else None,
            None if bone is None else bone.outer_mm,
            None if bone is None else bone.inner_mm,
        )
        from_tip = (
            None if distance_mm is None else max(0.0, distance_mm - BEHIND_MM) / MM_PER_M
            for distance_mm in distances_mm
        )
        return HeadAhead(*from_tip)

    def step(self, dt: float, phase: Phase, operator_input: OperatorInput, sim_time: float) -> Fed:
        """Feed for `dt` s in a phase; an event tells that the instrument meets another layer."""
        if phase not in FEED_PHASES:
            return NOT_FED
        before = self.feed
        way, is_by_stick = self.drive.way(dt, phase, operator_input)
        if way == 0.0:
            return NOT_FED
        self.feed = before.moved(phase, way)
        layer = self.feed.layer(phase)
        has_moved = self.feed.depth != before.depth
        if layer is before.layer(phase):
            return Fed(has_moved, is_by_stick)
        entry = FeedChange(phase, layer.value, MM_PER_M * self.feed.depth)
        return Fed(has_moved, is_by_stick, (Event(sim_time, entry),))

    def way(
        self, guide: GuideAxis, procedure: ProcedureState | None, stand_off_mm: float
    ) -> FollowingPath | LocalizedText:
        """Return the robot's own path to `stand_off_mm` before a planned entry, or why it has none.

        The line is the planned one by the registration in use.
        """
        if not self._may_align:
            return say("no self-alignment")
        outline = self._outline
        assert procedure is not None, "the phase has a procedure"
        assert procedure.registration is not None, "it is accepted"
        assert procedure.present is not None, "the phase has a trajectory"
        line, stand_off = procedure.present.line, stand_off_mm / MM_PER_M
        if not self._reach.can_hold_guide(line.entry, line.direction, [stand_off]):
            return say("line out of reach", stand_off=stand_off_mm)
        plan = RegisteredPlan.of(procedure.registration.matrix)
        assert plan is not None, "what is in use is rigid"

        def radius(direction: Vector) -> float:
            return outline.radius(vector(dot(row, direction) for row in plan.rows))

        middle = plan.in_world(outline.middle.tolist())
        return _guide_path(guide, line, stand_off, middle, radius)


TRAVEL_SPEED = 0.10
"""Speed of the tip around the head, m/s."""
APPROACH_SPEED = 0.03
"""Speed of the tip along the planned line, m/s."""
MARGIN = 0.03
"""How far the tip stays off the head on its path, m."""
STEP = math.radians(10.0)
"""Angle between two waypoints, seen from the middle of the head."""
_OUTWARD = 0.005

HeadRadius = Callable[[Vector], float]
"""Distance of the skin from the middle of the head in a direction (unit vector, World), m."""


def _guide_path(
    guide: GuideAxis, line: PlannedLine, stand_off: float, middle: Vector, radius: HeadRadius
) -> FollowingPath:
    """Return the path of the guide to `stand_off` m before a line's entry: out, around, and in.

    Middle (World, m) and radius of the head are by the registration in use.
    """

    def outside(position: Vector) -> bool:
        out = subtract(position, middle)
        return distance(position, middle) >= radius(unit(out)) + MARGIN

    inward = line.direction
    end = subtract(line.entry, scale(inward, stand_off))
    begin = end
    while not outside(begin):
        begin = subtract(begin, scale(inward, _OUTWARD))
    first, last = unit(subtract(guide.tip, middle)), unit(subtract(begin, middle))
    turn = angle(first, last)
    start_radius = max(distance(guide.tip, middle), radius(first) + MARGIN)
    end_radius = distance(begin, middle)
    steps = max(1, math.ceil(turn / STEP))
    lean = angle(guide.direction, inward)
    waypoints = []
    for number in range(steps):
        share = number / steps
        out = turned_toward(first, last, share * turn)
        direct = (1.0 - share) * start_radius + share * end_radius
        place = add(middle, scale(out, max(direct, radius(out) + MARGIN)))
        direction = turned_toward(guide.direction, inward, share * lean)
        waypoints.append((place, TRAVEL_SPEED, direction))
    last_two = (begin, TRAVEL_SPEED, inward), (end, APPROACH_SPEED, inward)
    return FollowingPath((*waypoints, *last_two))


_BANDS = 12
"""Bands of latitude; there are twice as many sectors of longitude."""


class HeadOutline:
    """The greatest distance of the skin from the middle of the head, by sectors of 15°."""

    def __init__(self, vertices: np.ndarray, middle: np.ndarray) -> None:
        """Take the head's vertices, (n, 3) float, and its middle, (3,) float, RAS mm."""
        self.middle = middle
        out = vertices - middle
        radii = np.linalg.norm(out, axis=1)
        x, y, z = (out / radii[:, None]).T
        bands = (_BANDS * np.arccos(np.clip(z, -1.0, 1.0)) / np.pi).astype(int)
        sectors = (_BANDS * (np.arctan2(y, x) + np.pi) / np.pi).astype(int)
        table = np.zeros((_BANDS, 2 * _BANDS))
        rows = np.minimum(bands, _BANDS - 1), np.minimum(sectors, 2 * _BANDS - 1)
        np.maximum.at(table, rows, radii)
        # A direction may be at the edge of its sector: the neighbors count, too.
        wide = np.maximum.reduce([np.roll(table, turn, axis=1) for turn in (-1, 0, 1)])
        tall = np.pad(wide, ((1, 1), (0, 0)), mode="edge")
        # Whole millimeters: the same on every computer.
        radii_mm = np.ceil(np.maximum.reduce([tall[:-2], tall[1:-1], tall[2:]]))
        for pole in (0, -1):
            radii_mm[pole] = radii_mm[pole].max()
        self._radii = (radii_mm / 1000.0).tolist()

    def radius(self, direction: Vector) -> float:
        """Return the distance in a direction (unit vector in the head's frame), m."""
        x, y, z = direction
        band = _BANDS * math.acos(min(max(z, -1.0), 1.0)) / math.pi
        sector = _BANDS * (math.atan2(y, x) + math.pi) / math.pi
        return self._radii[min(int(band), _BANDS - 1)][min(int(sector), 2 * _BANDS - 1)]
