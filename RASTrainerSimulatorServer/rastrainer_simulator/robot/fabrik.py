"""FABRIK for 7R S-R-S arms: tool position, position and direction, or full pose to joint angles.

1. A goal close by continues a motion: a position is predicted by a step along the Jacobian
   (`prediction`); with the tool held the elbow's path is predicted (`prediction` too), and close
   to a singularity it is slid to where the joints move least (`elbow_slide`). A goal far away
   starts from the last posture.
2. FABRIK reaches backward from the target and forward from the base (`fabrik_passes`), and each
   pass closes the elbow exactly (`closure`, `elbow_circle`): FABRIK alone converges slowly below a
   micrometer (J. Intell. Robot. Syst. 2023, 10.1007/s10846-023-01895-2).
3. The joint angles are read off the links, on the branch nearest to the last ones (`branches`).
4. What is out of reach is replaced by the nearest that is not (`reaching`).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from rastrainer.errors import InputError
from rastrainer_simulator.robot.arm_frame import ArmFrame, solve_rounded
from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm, Chain, chain
from rastrainer_simulator.robot.goal import (
    BLOCKED,
    OUT_OF_REACH,
    ROLL_BLOCKED,
    FabrikSettings,
    Goal,
    Solution,
)
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.robot.prediction import follow, predict
from rastrainer_simulator.robot.reaching import Reached, Start, reach_position, reach_wrist
from rastrainer_simulator.vectors import Vector

# A warm start that would move a joint farther than this (rad) looks for an elbow that avoids it.
_JUMP = 0.5
_BENT = 1e-6
# What the arithmetic of an exact S-R-S arm leaves over, m.
_ROUNDING = 1e-12


class Fabrik:
    """Inverse kinematics of one arm; without memory: the same question has the same answer."""

    def __init__(self, model: RobotModel, settings: FabrikSettings | None = None) -> None:
        self.settings = settings or FabrikSettings()
        self._frame = ArmFrame(model.geometry)
        self._arm = CanonicalArm.of(model.geometry)
        exact = model.geometry.misfit < _ROUNDING
        self._true = None if exact else make_kinematics(model)

    def solve(
        self,
        target_position: Sequence[float],
        target_direction: Sequence[float] | None = None,
        target_rotation: Sequence[Sequence[float]] | None = None,
        *,
        q_start: Sequence[float],
    ) -> Solution:
        """Return joint angles inside the limits that bring the tool to a target in World.

        `target_position` (3,) is that of the tip, m; `target_direction` (3,) that of the tool, from
        the wrist to the tip; `target_rotation` (3, 3) that of the tip's frame. Without direction
        and rotation only the position counts. Of all postures that reach the target, one
        near to `q_start` (7,) rad is chosen. Raises InputError for numbers that are no target.
        """
        target = (target_position, target_direction, target_rotation, q_start)
        if self._true:
            return solve_rounded(self._solve, self._true, self.settings, *target)
        return self._solve(*target)

    def _solve(
        self,
        position: Sequence[float],
        direction: Sequence[float] | None,
        rotation: Sequence[Sequence[float]] | None,
        q_start: Sequence[float],
    ) -> Solution:
        goal = self._goal(position, direction, rotation)
        aim = goal.within_lengths(self._arm)
        start: Angles = self._frame.theta(q_start)
        links = chain(start)
        if not aim.is_near(self._arm, links):
            reached = self._reach(goal, aim, start, links, inf)
        else:
            if aim.tool is None:
                start, links = predict(self._arm, start, links, aim.position)
            else:
                followed = follow(self._arm, start, links, aim)
                if followed is not None:
                    return self._solution(goal, followed, 1)
            reached = self._reach(goal, aim, start, links, _JUMP)
        return self._solution(goal, *reached)

    def _goal(
        self,
        position: Sequence[float],
        direction: Sequence[float] | None,
        rotation: Sequence[Sequence[float]] | None,
    ) -> Goal:
        target = self._frame.position(position)
        if rotation is None:
            tool = None if direction is None else self._frame.direction(direction)
            return Goal(target, tool, None)
        if direction is not None:
            raise InputError("Give the tool a direction or a rotation, not both.")
        x, y, z = self._frame.rotation(rotation)
        return Goal(target, z, (x, y))

    def _solution(self, goal: Goal, theta: Angles, passes: int, blocked: bool = False) -> Solution:
        off, turned = goal.errors(self._arm, theta, chain(theta))
        converged = self.settings.met(off, turned)
        if converged:
            reason = ""
        elif blocked:
            reason = BLOCKED
        else:
            reason = OUT_OF_REACH if off > self.settings.tolerance_m else ROLL_BLOCKED
        return Solution(self._frame.q(theta), off, turned, converged, passes, reason)

    def _reach(
        self, goal: Goal, aim: Goal, theta: Angles, links: Chain, farthest: float
    ) -> Reached:
        start = Start(theta, *self._wrist_and_elbow(theta, links), farthest)
        most = self.settings.max_iterations
        reach = reach_position if goal.tool is None else reach_wrist
        return reach(self._arm, goal, aim, start, most)

    def _wrist_and_elbow(self, theta: Angles, links: Chain) -> tuple[Vector, Vector]:
        a, b = self._arm.upper, self._arm.fore
        (ux, uy, uz), (fx, fy, fz), _, _, (nx, ny, nz), _ = links
        ex, ey, ez = a * ux, a * uy, a * uz
        wrist = (ex + b * fx, ey + b * fy, ez + b * fz)
        if -_BENT < theta[3] < _BENT:
            # A stretched arm has no plane; joint 4's axis determines in which it will bend.
            lean = -_BENT if theta[3] >= 0.0 else _BENT
            ex += lean * (ny * uz - nz * uy)
            ey += lean * (nz * ux - nx * uz)
            ez += lean * (nx * uy - ny * ux)
        return wrist, (ex, ey, ez)
