"""What a procedure does beside the arm: what lies ahead of the guide, what is fed, alignment."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.procedure.checks import planned_bone
from rastrainer.procedure.geometry import BoneAhead, bone_ahead, mesh_crossings
from rastrainer.protocol import Phase
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.touch_planner import PlanReach
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.state import Event, EventKind, OperatorInput
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


class TrueHead:
    """The surfaces of skin and skull of a scenario with procedures."""

    def __init__(self, scenario: Scenario, skin: HeadMesh) -> None:
        self._skin, self._skull = skin, read_head_mesh(scenario.skull_path)
        # Computed now, not in the tick in which the first guide is locked.
        _ = skin.triangle_spheres, self._skull.triangle_spheres
        self.planned_bone: PlannedBone = {
            each.name: tuple(planned_bone(line, self._skull) for line in each.trajectories)
            for each in scenario.procedures
        }

    def ahead(self, guide: GuideAxis, head_to_world: np.ndarray) -> HeadAhead:
        """Return what lies ahead along a guide's axis, with the head at (4, 4) float, m."""
        rotation, shift = head_to_world[:3, :3], head_to_world[:3, 3]
        axis = rotation.T @ np.array(guide.direction)
        tip_mm = MM_PER_M * (rotation.T @ (np.array(guide.tip) - shift))
        line = tip_mm - BEHIND_MM * axis, axis, MM_PER_M * LONGEST_FEED_M + BEHIND_MM
        crossings = mesh_crossings(self._skin, *line)
        bone = bone_ahead(self._skull, *line)
        return HeadAhead(
            skin=_from_tip(crossings[0].distance_mm) if crossings else None,
            outer=None if bone is None else _from_tip(bone.outer_mm),
            inner=None if bone is None or bone.inner_mm is None else _from_tip(bone.inner_mm),
        )


def _from_tip(distance_mm: float) -> float:
    return max(0.0, distance_mm - BEHIND_MM) / MM_PER_M


FEED_PHASES = (Phase.DRILLING, Phase.INSERTING)
"""The arm is held, and the instrument in the guide moves."""


class Fed(NamedTuple):
    """What a tick did to the instrument in the guide."""

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
        self._true_head: TrueHead | None = None
        self._outline: HeadOutline | None = None
        self.planned_bone: PlannedBone = {}
        if scenario.procedures:
            self._true_head = TrueHead(scenario, head)
            self.planned_bone = self._true_head.planned_bone
            self._outline = HeadOutline(head.vertices, scenario.target.position_ras)

    def reset(self, feed: Feed = NO_FEED) -> None:
        """Adopt a feed, and end a commanded one."""
        self.feed = feed
        self.drive.stop()

    def looking_ahead(self, guide: GuideAxis, head_to_world: np.ndarray) -> Feed:
        assert self._true_head is not None, "the phase has a procedure"
        return Feed(ahead=self._true_head.ahead(guide, head_to_world))

    def step(self, dt: float, phase: Phase, operator_input: OperatorInput, sim_time: float) -> Fed:
        """Feed for `dt` s in a phase, with an event where what is felt changes."""
        if phase not in FEED_PHASES:
            return NOT_FED
        before = self.feed
        way = self.drive.way(dt, phase, operator_input)
        if way.distance == 0.0:
            return NOT_FED
        self.feed = before.moved(phase, way.distance)
        layer = self.feed.layer(phase)
        has_moved = self.feed.depth != before.depth
        if layer is before.layer(phase):
            return Fed(has_moved, way.is_by_stick)
        depth_mm = MM_PER_M * self.feed.depth
        data = {"phase": phase.value, "layer": layer.value, "feedMm": depth_mm}
        event = Event(EventKind.FEED, sim_time, data)
        return Fed(has_moved, way.is_by_stick, (event,))

    def way(
        self, guide: GuideAxis, procedure: ProcedureState | None, stand_off_mm: float
    ) -> FollowingPath | LocalizedText:
        """Return the robot's own path onto the planned line, or why there is none.

        The line is by the registration in use; the tip ends `stand_off_mm` before its entry.
        """
        if not self._may_align:
            return say("no self-alignment")
        outline = self._outline
        assert procedure is not None, "the phase has a procedure"
        assert procedure.registration is not None, "it is accepted"
        assert procedure.present is not None, "the phase has a trajectory"
        assert outline is not None, "the scenario has a procedure"
        line, stand_off = procedure.present.line, stand_off_mm / MM_PER_M
        if not self._reach.judge_guide(line.entry, line.direction, [stand_off]).reachable:
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
"""Between two waypoints, seen from the middle of the head."""
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
"""Of latitude; there are twice as many sectors of longitude."""


class HeadOutline:
    """The greatest distance of the skin from the middle of the head, by sectors of 15°."""

    def __init__(self, vertices: np.ndarray, middle: np.ndarray) -> None:
        """Take the head's vertices, (n, 3) float, and its middle, (3,) float, RAS mm."""
        self.middle = middle
        out = vertices - middle
        radii = np.linalg.norm(out, axis=1)
        bands, sectors = _sectors(out / radii[:, None])
        table = np.zeros((_BANDS, 2 * _BANDS))
        np.maximum.at(table, (bands, sectors), radii)
        # A direction may lie at the edge of its sector: the neighbors count, too.
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


def _sectors(directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the band and the sector of unit vectors, (n,) int each."""
    x, y, z = directions.T
    bands = (_BANDS * np.arccos(np.clip(z, -1.0, 1.0)) / np.pi).astype(int)
    sectors = (_BANDS * (np.arctan2(y, x) + np.pi) / np.pi).astype(int)
    return np.minimum(bands, _BANDS - 1), np.minimum(sectors, 2 * _BANDS - 1)
