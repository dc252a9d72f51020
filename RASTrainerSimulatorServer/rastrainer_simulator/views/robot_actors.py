"""The robot as it is seen: its links in their paint, the tool's tip in the color of proximity."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from vtkmodules.vtkRenderingCore import vtkActor

from rastrainer.protocol import Proximity
from rastrainer_simulator.robot.meshes import load_meshes
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.views.actors import actor, surface
from rastrainer_simulator.views.materials import TIP_FREE, TIP_NEAR, painted


def robot_actors(
    robot: RobotModel, link_to_world: Mapping[str, np.ndarray], proximity: Proximity
) -> list[vtkActor]:
    """Return the robot's actors.

    `link_to_world` has a (4, 4) float pose in metres for every link with a mesh. The tip is blue,
    and red near and on the head. Raises InputError where a mesh cannot be read.
    """
    tip = TIP_FREE if proximity is Proximity.FREE else TIP_NEAR
    actors = []
    for link, parts in load_meshes(robot).items():
        for mesh, color in parts:
            material = tip if link == robot.tip.name else painted(color)
            actors.append(actor(surface(mesh.vertices, mesh.faces), material, link_to_world[link]))
    return actors
