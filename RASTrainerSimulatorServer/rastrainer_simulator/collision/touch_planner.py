"""Whether and how the robot can touch a point of the head or reach a planned target."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np

from rastrainer.transforms import frame_along
from rastrainer_simulator.collision.collision import Collision
from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.goal import FabrikSettings
from rastrainer_simulator.robot.kinematics import Kinematics, make_kinematics
from rastrainer_simulator.robot.model import RobotModel

CLEARANCE_M = 0.005
"""Clearance of the links to head, each other and table; the tool itself goes into the head."""
SHORTEST_TRAJECTORY_M = 1e-3
_UP = np.array([0.0, 0.0, 1.0])

OUT_OF_REACH = "The target is out of the robot's reach."
NO_ROOM = "The robot reaches the target, but its links come too close to the head or the table."
NOT_ALONG = "The robot cannot hold its tool along the whole trajectory; choose another entry point."


class PlanAnswer(NamedTuple):
    """Whether a plan can be carried out, and if not, a sentence about the reason."""

    reachable: bool
    reason: str


class PlanReach:
    """Judges whether the robot reaches a target with its tool along a trajectory to it."""

    def __init__(self, model: RobotModel, kinematics: Kinematics, collision: Collision) -> None:
        self._home = model.home
        self._fabrik = Fabrik(model)
        self._kinematics = kinematics
        self._collision = collision

    def judge(self, target: Sequence[float], entry: Sequence[float] | None) -> PlanAnswer:
        """Return whether a plan can be carried out in the present pose of the head.

        Both points are (3,) float, World, m. The trajectory starts at the entry; None leaves the
        tool's direction free.
        """
        if not self._fabrik.solve(target, q_start=self._home).converged:
            return PlanAnswer(False, OUT_OF_REACH)
        end = np.asarray(target, dtype=float)
        if entry is not None:
            begin = np.asarray(entry, dtype=float)
            along = end - begin
            if np.linalg.norm(along) > SHORTEST_TRAJECTORY_M:
                is_held = all(self._has_room(each, along) for each in (begin, end))
                return PlanAnswer(is_held, "" if is_held else NOT_ALONG)
        for _leaning, direction in tool_directions(_UP):
            if self._has_room(end, direction):
                return PlanAnswer(True, "")
        return PlanAnswer(False, NO_ROOM)

    def can_hold_guide(
        self, entry: Sequence[float], direction: Sequence[float], stand_offs: Iterable[float]
    ) -> bool:
        """Return whether the guide can be held on a line before the head, in its present pose.

        Entry and direction (a unit vector into the head) are (3,) float, World; `stand_offs` are
        distances of the guide's tip from the entry, m.
        """
        begin, along = np.asarray(entry, dtype=float), np.asarray(direction, dtype=float)
        return all(self._has_room(begin - each * along, along) for each in stand_offs)

    def _has_room(self, position: np.ndarray, direction: np.ndarray) -> bool:
        solution = self._fabrik.solve(position.tolist(), direction.tolist(), q_start=self._home)
        if not solution.converged:
            return False
        clearance = self._collision.check(self._kinematics.links(solution.q))
        return min(clearance.links_m, clearance.self_m, clearance.table_m) >= CLEARANCE_M


LEANING_DEG = (0.0, 20.0, 40.0, 55.0)
"""How far the tool may lean away from the skin's normal; tried in this order."""

_AZIMUTHS = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False).tolist()
_LEANINGS = ((LEANING_DEG[0], 0.0), *product(LEANING_DEG[1:], _AZIMUTHS))
"""How far each direction leans, degrees, and to which side, rad."""

SWIVELS_DEG = (0.0, 60.0, -60.0)
"""Turns of the first joint, undone by the third, from which the elbow is searched."""


@dataclass(frozen=True)
class PlannedTouch:
    """A planned touch of a point: joint angles, rad, and the tool's direction (3,), World.

    It leans from the inward normal, and has a number among the `tool_directions`.
    """

    q: tuple[float, ...]
    direction: np.ndarray
    leaning_deg: float
    number: int


class TouchPlanner:
    """Looks for a posture that touches a place with nothing but the tip, inside the joint limits.

    The links keep `CLEARANCE_M`. The tool's shaft need only be clear of the head: next to the tip
    it cannot be farther away.
    """

    def __init__(self, model: RobotModel, collision: Collision) -> None:
        self._collision = collision
        self._kinematics = make_kinematics(model)
        # No later pass can hold a goal that the first cannot: it would only approach it.
        self._fabrik = Fabrik(model, FabrikSettings(max_iterations=1))
        turns = np.outer(np.radians(SWIVELS_DEG), (1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0))
        self._starts = [tuple(q) for q in (np.array(model.home) + turns).tolist()]

    def touch(
        self, position: np.ndarray, normal: np.ndarray, likely: int = 0
    ) -> PlannedTouch | None:
        """Return a touch of a point of the skin, None if there is none.

        The least leaning of `LEANING_DEG` that works is taken, unless the `likely` one of the
        `tool_directions` does: a choice for one pose of the head mostly fits others, too, which
        saves many tries. Position (m) and outward unit normal there are (3,) float, World.
        """
        frame = frame_along(normal)
        for number in (likely, *(each for each in range(len(_LEANINGS)) if each != likely)):
            direction = _leaning(frame, number)
            for start in self._starts:
                solution = self._fabrik.solve(position.tolist(), direction.tolist(), q_start=start)
                if not solution.converged:
                    break
                links = self._kinematics.links(solution.q)
                if self._collision.is_clear(links, CLEARANCE_M):
                    return PlannedTouch(solution.q, direction, _LEANINGS[number][0], number)
        return None


def tool_directions(normal: np.ndarray) -> Iterator[tuple[float, np.ndarray]]:
    frame = frame_along(normal)
    for number, (leaning_deg, _azimuth) in enumerate(_LEANINGS):
        yield leaning_deg, _leaning(frame, number)


def _leaning(frame: np.ndarray, number: int) -> np.ndarray:
    leaning, azimuth = np.radians(_LEANINGS[number][0]), _LEANINGS[number][1]
    across, along, normal = frame
    aside = np.cos(azimuth) * across + np.sin(azimuth) * along
    return np.sin(leaning) * aside - np.cos(leaning) * normal
