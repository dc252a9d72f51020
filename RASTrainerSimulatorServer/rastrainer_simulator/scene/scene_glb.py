"""One scene as a GLB file, made of a scenario, a robot and a task."""

from __future__ import annotations

from rastrainer.head_mesh import read_head_mesh
from rastrainer.scenario import Scenario
from rastrainer.tasks import Task
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.scene.glb import to_glb
from rastrainer_simulator.scene.head_nodes import head_node
from rastrainer_simulator.scene.robot_nodes import robot_nodes
from rastrainer_simulator.scene.room_nodes import room_nodes, stand_node


def scene_glb(scenario: Scenario, robot: RobotModel, task: Task | None) -> bytes:
    """Return the GLB that docs/views.md describes; takes seconds, and imports VTK.

    Raises:
        InputError: a mesh cannot be read.
    """
    head = read_head_mesh(scenario.head_mesh)
    nodes = [
        *robot_nodes(robot),
        head_node(head, task),
        stand_node(scenario.furniture, 0.15),
        *room_nodes(scenario.furniture),
    ]
    return to_glb(nodes)
