"""The arm in a simulation: how its joints follow the tip, and where trials start."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rastrainer.errors import InputError
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.goal import FabrikSettings
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.vectors import Vector, add, cross, length, scale

Joints = tuple[float, ...]

DOWN: Vector = (0.0, 0.0, -1.0)
RELAXING_DISTANCE = 0.4
"""m: over such a path of the tip the arm's redundancy relaxes by the factor e."""


class JointMotion:
    """Moves the joints toward a target of the tip; it stores no posture itself."""

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
        """Return the joint angles after `dt` toward a target, and whether it is within reach.

        The tip, at `tip` with the joint angles `start`, is to move by `displacement` (World, m)
        and the tool to point along `direction`, a unit vector, None if it is free; `across` is the
        x axis of its tip, a unit vector perpendicular to `direction`, None if it may roll. The
        tip's position comes first: where the joint limits forbid the direction, or the joints are
        too slow for it, the tool turns as far as it can while the tip stays on its straight path.
        """
        # A little nearer to rest: FABRIK then brings the tip to its target. Without it the elbow
        # would drift as the tip moves until it hangs on a limit or the table. The farther the tip
        # moves, the more: a resting tip moves no joint.
        relaxed = length(displacement) / RELAXING_DISTANCE
        near = tuple(
            angle + relaxed * (rest - angle) for angle, rest in zip(start, self._rest, strict=True)
        )
        target = add(tip, displacement)
        if across is None or direction is None:
            solution = self._fabrik.solve(target, direction, q_start=near)
        else:
            rotation = tuple(zip(across, cross(direction, across), direction, strict=True))
            solution = self._fabrik.solve(target, None, rotation, q_start=near)
        q, is_limited = limit_step(start, solution.q, self._fastest, dt)
        if direction is None or (solution.converged and not is_limited):
            return q, solution.converged
        share = 1.0
        if is_limited:
            turns = [(abs(b - a), abs(c - a)) for a, b, c in zip(start, q, solution.q, strict=True)]
            made, needed = max(turns, key=lambda pair: pair[1])
            share = made / needed
        found = self._fabrik.solve(add(tip, scale(displacement, share)), q_start=q)
        return limit_step(start, found.q, self._fastest, dt)[0], found.converged


def start_joints(robot: RobotModel, scenario: Scenario, height: float) -> tuple[float, ...]:
    """Return the joint angles with the tip `height` m above the head's target, nominally placed."""
    solution = Fabrik(robot).solve(start_tip(scenario, height), DOWN, q_start=robot.home)
    if not solution.converged:
        raise InputError(
            f"The robot cannot reach {height:g} m above the head of {scenario.name}, where trials "
            f"start: {solution.reason}"
        )
    return solution.q


def start_tip(scenario: Scenario, height: float) -> Vector:
    """Return where the tip is at the start: `height` m above the head's target, World, m."""
    rotation, shift = scenario.head_to_world[:3, :3], scenario.head_to_world[:3, 3]
    x, y, z = (np.asarray(rotation @ scenario.target.position_ras + shift) / MM_PER_M).tolist()
    return x, y, z + height


def limit_step(
    q: Sequence[float], goal: Sequence[float], velocity: Sequence[float], dt: float
) -> tuple[Joints, bool]:
    """Return `q` after a tick of `dt` s toward `goal` (rad), and whether `velocity` limited it.

    All joints are slowed alike, so they arrive together and each stays between start and goal.
    """
    steps = [b - a for a, b in zip(q, goal, strict=True)]
    slowest = max([abs(step) / (speed * dt) for step, speed in zip(steps, velocity, strict=True)])
    if slowest <= 1.0:
        return tuple(goal), False
    return tuple([a + step / slowest for a, step in zip(q, steps, strict=True)]), True
