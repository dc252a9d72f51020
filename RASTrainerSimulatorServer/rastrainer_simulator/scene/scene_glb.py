"""One scene as a GLB file, made of a scenario, a robot and a task."""

from __future__ import annotations

import numpy as np

from rastrainer.head_mesh import HeadMesh, read_head_mesh
from rastrainer.scenario import Scenario
from rastrainer.tasks import Task
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.scene.glb import to_glb
from rastrainer_simulator.scene.head_nodes import head_node
from rastrainer_simulator.scene.nodes import Node
from rastrainer_simulator.scene.robot_nodes import robot_nodes
from rastrainer_simulator.scene.room_nodes import room_nodes
from rastrainer_simulator.scene.table_nodes import stand_node, table_node

MM_IN_M = 1000.0


def scene_glb(scenario: Scenario, robot: RobotModel, task: Task | None) -> bytes:
    """Return the GLB that docs/views.md describes; takes seconds, and imports VTK.

    Raises:
        InputError: a mesh cannot be read.
    """
    return to_glb(scene_nodes(scenario, robot, read_head_mesh(scenario.head_mesh), task))


def scene_nodes(
    scenario: Scenario, robot: RobotModel, head: HeadMesh, task: Task | None
) -> list[Node]:
    """Return what stands in World; what moves has its place from the simulation's state.

    Raises:
        InputError: a mesh cannot be read.
    """
    base = (scenario.head_to_world @ np.append(head.base, 1.0))[:3] / MM_IN_M
    return [
        *robot_nodes(robot),
        head_node(head, task),
        stand_node(scenario.furniture, base),
        table_node(scenario.furniture, base),
        *room_nodes(),
    ]
