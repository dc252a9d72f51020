"""Can the robot carry out what was planned on the MRI, along the whole trajectory?"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rastrainer_simulator.collision.collision import Collision
from rastrainer_simulator.collision.touch_planner import tool_directions
from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.kinematics import Kinematics
from rastrainer_simulator.robot.model import RobotModel

CLEARANCE_M = 0.005
"""Of the links to the head, to each other and to the table; the tool itself goes into the head."""
SHORTEST_TRAJECTORY_M = 1e-3
_UP = np.array([0.0, 0.0, 1.0])

OUT_OF_REACH = "The target is out of the robot's reach."
NO_ROOM = "The robot reaches the target, but its links come too near to the head or the table."
NOT_ALONG = "The robot cannot hold its tool along the whole trajectory; choose another entry point."


class PlanAnswer(NamedTuple):
    """Whether a plan can be carried out, and a sentence that says why not, empty where it can."""

    reachable: bool
    reason: str


class PlanReach:
    """Tells whether the robot reaches a target, and holds its tool along a trajectory to it."""

    def __init__(self, model: RobotModel, kinematics: Kinematics, collision: Collision) -> None:
        self._home = model.home
        self._fabrik = Fabrik(model)
        self._kinematics = kinematics
        self._collision = collision

    def judge(self, target: Sequence[float], entry: Sequence[float] | None) -> PlanAnswer:
        """Return whether a plan can be carried out with the head where it stands.

        Args:
            target: (3,) float, World, m.
            entry: (3,) float, World, m: where the trajectory begins; None leaves the tool's
                direction free.
        """
        if not self._fabrik.solve(target, q_start=self._home).converged:
            return PlanAnswer(False, OUT_OF_REACH)
        end = np.asarray(target, dtype=float)
        if entry is not None:
            begin = np.asarray(entry, dtype=float)
            along = end - begin
            if np.linalg.norm(along) > SHORTEST_TRAJECTORY_M:
                ends = (begin, end)
                is_held = all(self._has_room(each, along) for each in ends)
                return PlanAnswer(is_held, "" if is_held else NOT_ALONG)
        for _leaning, direction in tool_directions(_UP):
            if self._has_room(end, direction):
                return PlanAnswer(True, "")
        return PlanAnswer(False, NO_ROOM)

    def _has_room(self, position: np.ndarray, direction: np.ndarray) -> bool:
        solution = self._fabrik.solve(position.tolist(), direction.tolist(), q_start=self._home)
        if not solution.converged:
            return False
        clearance = self._collision.check(self._kinematics.links(solution.q))
        return min(clearance.links_m, clearance.self_m, clearance.table_m) >= CLEARANCE_M
