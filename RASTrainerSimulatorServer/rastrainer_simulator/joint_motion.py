"""From where the tip shall be to joint angles: inverse kinematics within the joints' speed."""

from __future__ import annotations

from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.robot.solution import FabrikSettings
from rastrainer_simulator.robot.velocity_limit import limit_step
from rastrainer_simulator.vectors import Vector, add, cross, length, scale

Joints = tuple[float, ...]

RELAXING_WAY = 0.4
"""m: on such a way of the tip the arm's redundancy relaxes by the factor e."""


class JointMotion:
    """Moves the joints toward a target of the tip; it keeps no posture itself."""

    def __init__(
        self, robot: RobotModel, rest: Joints, settings: FabrikSettings | None = None
    ) -> None:
        """`rest` are the joint angles (rad) to which the arm's redundancy relaxes."""
        self._rest = rest
        self._fabrik = Fabrik(robot, settings)
        self._fastest = tuple(robot.velocity.tolist())

    def toward(
        self,
        start: Joints,
        tip: Vector,
        displacement: Vector,
        direction: Vector | None,
        dt: float,
        across: Vector | None = None,
    ) -> tuple[Joints, bool]:
        """Return the joint angles after `dt` on the way to a target, and if it is within reach.

        The tip, now at `tip` with the joint angles `start`, shall move by `displacement` (World, m)
        and the tool point along `direction`, a unit vector, None where it is free; `across` is the
        x axis of its tip, a unit vector perpendicular to `direction`, None where it may roll. The
        tip's position comes first: where the joint limits forbid the direction, or the joints are
        too slow for it, the tool turns as far as it can while the tip stays on its straight way.
        """
        near = self._relaxed(start, length(displacement))
        target = add(tip, displacement)
        if across is None:
            solution = self._fabrik.solve(target, direction, q_start=near)
        else:
            rotation = tuple(zip(across, cross(direction, across), direction, strict=True))
            solution = self._fabrik.solve(target, None, rotation, q_start=near)
        step = limit_step(start, solution.q, self._fastest, dt)
        if direction is None or (solution.converged and not step.limited):
            return step.q, solution.converged
        share = _share(start, step.q, solution.q) if step.limited else 1.0
        on_the_way = add(tip, scale(displacement, share))
        found = self._fabrik.solve(on_the_way, q_start=step.q)
        return limit_step(start, found.q, self._fastest, dt).q, found.converged

    def _relaxed(self, q: Joints, way: float) -> Joints:
        """Return the angles a little nearer to rest: FABRIK then brings the tip to its target.

        Without it the elbow would wander with the ways of the tip until it hangs on a limit or the
        table. The farther the tip moves, the more: a resting tip moves no joint.
        """
        share = way / RELAXING_WAY
        return tuple(
            angle + share * (rest - angle) for angle, rest in zip(q, self._rest, strict=True)
        )


def _share(start: Joints, part: Joints, whole: Joints) -> float:
    """Return how much of the way from `start` to `whole` has been made at `part`."""
    ways = [(abs(b - a), abs(c - a)) for a, b, c in zip(start, part, whole, strict=True)]
    made, way = max(ways, key=lambda pair: pair[1])
    return made / way
