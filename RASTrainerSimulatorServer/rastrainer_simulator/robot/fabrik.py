"""FABRIK for 7R S-R-S arms: tool position, position and direction, or full pose to joint angles.

1. A near goal is predicted by a step along the Jacobian (`prediction`); a far one starts from the
   last posture.
2. FABRIK reaches backward from the target and forward from the base (`fabrik_passes`), and each
   pass closes the elbow exactly (`closure`, `elbow_circle`): FABRIK alone converges slowly below a
   micrometre (J. Intell. Robot. Syst. 2023, 10.1007/s10846-023-01895-2).
3. The joint angles are read off the links, on the branch nearest to the last ones (`branches`).
4. What is out of reach is replaced by the nearest that is not (`reaching`, `nearest_reach`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import NamedTuple

from rastrainer.errors import InputError
from rastrainer_simulator.robot.arm_frame import ArmFrame
from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm, Chain, chain
from rastrainer_simulator.robot.goal import Goal
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.robot.prediction import predict
from rastrainer_simulator.robot.reaching import (
    OUT_OF_REACH,
    Reached,
    Start,
    reach_position,
    reach_wrist,
)
from rastrainer_simulator.vectors import Vector

# A warm start that would move a joint farther than this (rad) looks for an elbow that avoids it.
_JUMP = 0.5
_BENT = 1e-6


@dataclass(frozen=True)
class FabrikSettings:
    """When a solution is good enough, and when the passes give up."""

    tolerance_m: float = 1e-9
    tolerance_rad: float = 1e-8
    max_iterations: int = 16

    def __post_init__(self) -> None:
        """Raise InputError for settings that could never end or never succeed."""
        if not (self.tolerance_m > 0.0 and self.tolerance_rad > 0.0 and self.max_iterations >= 1):
            raise InputError("FABRIK needs tolerances above zero and at least one iteration.")


class Solution(NamedTuple):
    """Joint angles (rad), and how far from the target they hold the tool."""

    q: tuple[float, ...]
    position_error_m: float
    direction_error_rad: float
    converged: bool
    iterations: int
    reason: str


class Fabrik:
    """Inverse kinematics of one arm; without memory: the same question has the same answer."""

    def __init__(self, model: RobotModel, settings: FabrikSettings | None = None) -> None:
        self.settings = settings or FabrikSettings()
        self._frame = ArmFrame(model.geometry)
        self._arm = CanonicalArm.of(model.geometry)

    def solve(
        self,
        target_position: Sequence[float],
        target_direction: Sequence[float] | None = None,
        target_rotation: Sequence[Sequence[float]] | None = None,
        *,
        q_start: Sequence[float],
    ) -> Solution:
        """Return joint angles inside the limits that bring the tool to a target in World.

        `target_position` (3,) is where the tip shall be, in m. `target_direction` (3,) is where the
        tool shall point, from the wrist to the tip; `target_rotation` (3, 3) how the tip's frame
        shall be turned; with neither, only the position counts. Of all postures that do it, one
        near to `q_start` (7,) rad is chosen. Raises InputError for numbers that are no target.
        """
        goal = self._goal(target_position, target_direction, target_rotation)
        start = self._frame.theta(q_start)
        links = chain(start)
        near = predict(self._arm, start, links, goal)
        reached = self._reach(goal, *near, _JUMP) if near else self._reach(goal, start, links, inf)
        return self._solution(goal, *reached)

    def _goal(
        self,
        position: Sequence[float],
        direction: Sequence[float] | None,
        rotation: Sequence[Sequence[float]] | None,
    ) -> Goal:
        target = self._frame.position(position)
        if direction is None and rotation is None:
            return Goal(target, None, None)
        if rotation is None:
            return Goal(target, self._frame.direction(direction), None)
        if direction is not None:
            raise InputError("Give the tool a direction or a rotation, not both.")
        x, y, tool = self._frame.rotation(rotation)
        return Goal(target, tool, (x, y))

    def _solution(self, goal: Goal, theta: Angles, iterations: int, reason: str) -> Solution:
        off, turned = goal.errors(self._arm, theta, chain(theta))
        converged = off <= self.settings.tolerance_m and turned <= self.settings.tolerance_rad
        reason = "" if converged else reason or OUT_OF_REACH
        return Solution(self._frame.q(theta), off, turned, converged, iterations, reason)

    def _reach(self, goal: Goal, theta: Angles, links: Chain, farthest: float) -> Reached:
        start = Start(theta, *self._wrist_and_elbow(theta, links), farthest)
        most = self.settings.max_iterations
        if goal.tool is None:
            return reach_position(self._arm, goal.position, start, most)
        return reach_wrist(self._arm, goal, start, most)

    def _wrist_and_elbow(self, theta: Angles, links: Chain) -> tuple[Vector, Vector]:
        a, b = self._arm.upper, self._arm.fore
        (ux, uy, uz), (fx, fy, fz), _, _, (nx, ny, nz), _ = links
        ex, ey, ez = a * ux, a * uy, a * uz
        wrist = (ex + b * fx, ey + b * fy, ez + b * fz)
        if -_BENT < theta[3] < _BENT:
            # A stretched arm has no plane; joint 4's axis tells in which it will bend.
            lean = -_BENT if theta[3] >= 0.0 else _BENT
            ex += lean * (ny * uz - nz * uy)
            ey += lean * (nz * ux - nx * uz)
            ez += lean * (nx * uy - ny * ux)
        return wrist, (ex, ey, ez)
