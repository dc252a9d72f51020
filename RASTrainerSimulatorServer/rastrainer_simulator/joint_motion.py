"""From where the tip shall be to joint angles: inverse kinematics within the joints' speed."""

from __future__ import annotations

from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.vectors import Vector

Joints = tuple[float, ...]


class JointMotion:
    """Moves the joints toward a target; it keeps no posture itself."""

    def __init__(self, robot: RobotModel) -> None:
        self._fabrik = Fabrik(robot)
        self._fastest = tuple(float(speed) for speed in robot.velocity)

    def toward(
        self, start: Joints, position: Vector, direction: Vector | None, dt: float
    ) -> tuple[Joints, bool]:
        """Return the joint angles after `dt` on the way to a target, and if it is within reach.

        `position` is the tip's in World, m; `direction` the tool's, a unit vector, None where it is
        free. All joints are slowed down by the same factor where one would be too fast, so that
        the way in joint space stays the same.
        """
        solution = self._fabrik.solve(position, direction, q_start=start)
        excess = max(
            abs(new - old) / (fastest * dt)
            for old, new, fastest in zip(start, solution.q, self._fastest, strict=True)
        )
        if excess <= 1.0:
            return solution.q, solution.converged
        steps = zip(start, solution.q, strict=True)
        return tuple(old + (new - old) / excess for old, new in steps), solution.converged
