"""Where the arm waits when a trial begins: above the head, the tool straight down."""

from __future__ import annotations

import numpy as np

from rastrainer.errors import InputError
from rastrainer.scenario import Scenario
from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.vectors import Vector

DOWN: Vector = (0.0, 0.0, -1.0)
MM = 1000.0


def start_joints(robot: RobotModel, scenario: Scenario, height: float) -> tuple[float, ...]:
    """Return the joint angles with the tip `height` m above the head's target, nominally placed.

    Raises:
        InputError: the robot cannot get there.
    """
    rotation, shift = scenario.head_to_world[:3, :3], scenario.head_to_world[:3, 3]
    x, y, z = (np.asarray(rotation @ scenario.target_position + shift) / MM).tolist()
    solution = Fabrik(robot).solve((x, y, z + height), DOWN, q_start=robot.home)
    if not solution.converged:
        raise InputError(
            f"The robot cannot reach {height:g} m above the head of {scenario.name}, where trials "
            f"start: {solution.reason}"
        )
    return solution.q
