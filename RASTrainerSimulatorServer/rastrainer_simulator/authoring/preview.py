"""A scenario's preview: its head in the close-up view, with a task's marks."""

from __future__ import annotations

from pathlib import Path

from rastrainer.head.mesh import HeadMesh
from rastrainer.protocol import Proximity
from rastrainer.scenario.scenario import Scenario
from rastrainer_simulator.core.arm import start_joints
from rastrainer_simulator.core.settings import SimulationSettings
from rastrainer_simulator.rendering.lighting import Shadows
from rastrainer_simulator.rendering.picture import SceneMoment, render_picture
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import load_robot
from rastrainer_simulator.scene.scene_glb import scene_nodes

SIZE = (640, 480)


def draw_preview(path: Path, scenario: Scenario, head: HeadMesh) -> None:
    """Draw the head as a trainee first sees it, with the first task if there is one.

    Raises:
        InputError: the picture cannot be written.
    """
    robot = load_robot()
    q = start_joints(robot, scenario, SimulationSettings().start_height)
    moment = SceneMoment(
        link_to_world=make_kinematics(robot).links(q),
        head_to_world=scenario.head_to_world,
        head_base=head.base,
        touched=frozenset(),
        proximity=Proximity.FREE,
    )
    task = scenario.tasks[0] if scenario.tasks else None
    nodes = scene_nodes(scenario, robot, head, task)
    camera = scenario.cameras["close-up"]
    render_picture(path, nodes, robot, moment, camera, size=SIZE, shadows=Shadows.SMALL)
