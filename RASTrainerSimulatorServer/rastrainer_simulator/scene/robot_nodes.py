"""The robot as nodes: `link_0` … `link_7`, and `tool` with its `tip_marker`."""

from __future__ import annotations

import numpy as np

from rastrainer_simulator.robot.meshes import load_meshes
from rastrainer_simulator.robot.model import RobotLink, RobotModel
from rastrainer_simulator.scene.materials import TIP_FREE, painted
from rastrainer_simulator.scene.nodes import Node, Surface, merged
from rastrainer_simulator.scene.surfaces import shaded

TOOL = "tool"
TIP_MARKER = "tip_marker"


def link_node_name(joint: int) -> str:
    """Return the name of the node that moves behind that many joints."""
    return f"link_{joint}"


def robot_nodes(robot: RobotModel) -> list[Node]:
    """Return the nodes of a robot, each in the frame that the stream moves.

    What is fixed behind the flange is the tool; its node's origin is the tool's tip.

    Raises:
        InputError: a mesh cannot be read.
    """
    first = _first_links(robot)
    tip_to_flange = robot.tip.offset
    surfaces: dict[str, list[Surface]] = {link_node_name(joint): [] for joint in first}
    surfaces[TOOL] = []
    marker: list[Surface] = []
    links = {link.name: link for link in robot.links}
    for name, parts in load_meshes(robot).items():
        link = links[name]
        is_tool = link.joint == len(robot.joints) and link is not first[link.joint]
        frame = tip_to_flange if is_tool else first[link.joint].offset
        to_node = np.linalg.inv(frame) @ link.offset
        for mesh, color in parts:
            mesh.apply_transform(to_node)
            is_marker = name == robot.tip.name
            material = TIP_FREE if is_marker else painted(color)
            surface = shaded(mesh.vertices, mesh.faces, material)
            place = surfaces[TOOL] if is_tool else surfaces[link_node_name(link.joint)]
            (marker if is_marker else place).append(surface)
    nodes = [Node(name, merged(group)) for name, group in surfaces.items() if name != TOOL]
    tip_marker = Node(TIP_MARKER, merged(marker))
    return [*nodes, Node(TOOL, merged(surfaces[TOOL]), (tip_marker,))]


def _first_links(robot: RobotModel) -> dict[int, RobotLink]:
    """Return the link whose pose the state tells, for each count of joints before it."""
    first: dict[int, RobotLink] = {}
    for link in robot.links:
        first.setdefault(link.joint, link)
    return first
