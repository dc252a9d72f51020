"""One scene as a GLB file, made of a scenario, a robot and a task.

Run as a short-lived process, since VTK would stop the control loop's, it has as arguments the
folders of the scenario and of the robot's meshes ("" for those that come with RASTrainer), the name
of a task ("" for none) and the file to write.
"""

from __future__ import annotations

import contextlib
import functools
import os
import sys
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

import numpy as np

if __name__ == "__main__":
    # Views wait for this process: trimesh would import scipy, a third of a second, for nothing.
    sys.modules["scipy"] = None  # type: ignore[assignment]
import trimesh
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from rastrainer.errors import InputError
from rastrainer.files.writing import write_bytes
from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.procedure.plan import Procedure, read_no_go_mesh
from rastrainer.scenario.points import Task
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.robot.meshes import load_meshes
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.scene.nodes import (
    AXIS,
    DRILL,
    ELECTRODE,
    GUIDE,
    NO_GO,
    SKIN,
    TIP_FREE,
    TIP_MARKER,
    TOOL,
    Material,
    Node,
    Surface,
    link_node_name,
    merged,
    no_go_name,
    painted,
)
from rastrainer_simulator.scene.room_nodes import room_nodes, stand_node, table_node
from rastrainer_simulator.scene.skin_marks import skin_marks
from rastrainer_simulator.scene.surfaces import shaded, turned


def robot_nodes(robot: RobotModel) -> list[Node]:
    """Return the nodes of a robot, each in the frame that the stream moves.

    All links fixed behind the flange make the tool; its node's origin is the tool's tip.
    """
    first, links = robot.moving_links, {link.name: link for link in robot.links}
    surfaces: dict[str, list[Surface]] = defaultdict(list)
    for name, parts in load_meshes(robot).items():
        link = links[name]
        is_tool = link.joint == len(robot.joints) and link is not first[link.joint]
        frame = robot.tip.offset if is_tool else first[link.joint].offset
        node = TOOL if is_tool else link_node_name(link.joint)
        for mesh, color in parts:
            mesh.apply_transform(np.linalg.inv(frame) @ link.offset)
            is_marker = name == robot.tip.name
            material = TIP_FREE if is_marker else painted(color)
            surface = shaded(mesh.vertices, mesh.faces, material)
            surfaces[TIP_MARKER if is_marker else node].append(surface)
    arm = (link_node_name(link.joint) for link in first)
    parts_of_tool = (Node(TIP_MARKER, merged(surfaces[TIP_MARKER])), *_instrument_nodes())
    return [
        *(Node(name, merged(surfaces[name])) for name in arm),
        Node(TOOL, merged(surfaces[TOOL]), parts_of_tool),
    ]


PLAN = "plan"
SLEEVE_LENGTH, SLEEVE_RADIUS, MOUTH_RADIUS = 0.075, 0.0065, 0.0035
AXIS_LENGTH, AXIS_RADIUS = 0.2, 0.00035
DRILL_RADIUS, ELECTRODE_RADIUS = 0.0016, 0.0011
"""As drawn; an electrode is mostly thinner, and would be hardly visible."""


def _instrument_nodes() -> tuple[Node, ...]:
    """Return what the tool holds in a procedure; its frame's origin is the tip, z is the axis.

    `drill` and `electrode` are 1 m long: a view scales them along z by how far they are fed.
    """
    profiles = {
        GUIDE: [
            (SLEEVE_RADIUS, -SLEEVE_LENGTH),
            (SLEEVE_RADIUS, -0.2 * SLEEVE_LENGTH),
            (MOUTH_RADIUS, 0.0),
        ],
        AXIS: [(AXIS_RADIUS, 0.0), (AXIS_RADIUS, AXIS_LENGTH)],
        DRILL: [(DRILL_RADIUS, 0.0), (DRILL_RADIUS, 1.0)],
        ELECTRODE: [(ELECTRODE_RADIUS, 0.0), (ELECTRODE_RADIUS, 1.0)],
    }
    return tuple(
        Node(material.name, (turned(0.0, 0.0, profile, material),), is_hidden=True)
        for material, profile in profiles.items()
    )


def plan_node(procedures: Sequence[Procedure]) -> Node:
    """Return the node that the stream puts where a registration has the MRI: RAS, but in m.

    Its children are the no-go structures of all procedures, one for each file.
    """
    nodes = []
    for path in sorted({each.file for procedure in procedures for each in procedure.no_go}):
        mesh = read_no_go_mesh(path)
        surface = shaded(mesh.vertices / MM_PER_M, mesh.triangles, NO_GO)
        nodes.append(Node(no_go_name(path), (surface,), is_hidden=True))
    return Node(PLAN, children=tuple(nodes))


ROOT = "scene"
WORLD = "world"
# glTF's y is up, as World's z is; x stays.
WORLD_TO_GLTF = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], dtype=float)


@functools.cache
def _material(material: Material) -> PBRMaterial:
    color = np.array(material.linear_color)
    # A glowing surface is black to lamps: it has its own color in any light.
    base, glow = (np.zeros(3), color) if material.glowing else (color, np.zeros(3))
    return PBRMaterial(
        name=material.name,
        alphaMode="OPAQUE" if material.opacity == 1.0 else "BLEND",
        baseColorFactor=[*base, material.opacity],
        metallicFactor=material.metallic,
        roughnessFactor=material.roughness,
        emissiveFactor=glow,
    )


def _add(scene: trimesh.Scene, parent: str, node: Node) -> None:
    is_single = len(node.surfaces) == 1
    if not is_single:
        scene.graph.update(frame_from=parent, frame_to=node.name, matrix=np.eye(4))
    for surface in node.surfaces:
        mesh = trimesh.Trimesh(
            surface.vertices,
            surface.triangles,
            vertex_normals=surface.normals,
            visual=TextureVisuals(material=_material(surface.material)),
            process=False,
        )
        name = node.name if is_single else f"{node.name}_{surface.material.name}"
        scene.add_geometry(
            mesh,
            node_name=name,
            geom_name=name,
            parent_node_name=parent if is_single else node.name,
            transform=np.eye(4),
        )
    for child in node.children:
        _add(scene, node.name, child)


BASE_CREASE_DEG = 60.0
"""The rim of the flat base is sharper than this; nothing of a face is."""


def head_node(mesh: HeadMesh, task: Task | None) -> Node:
    """Return the head in its own frame: RAS, but in m; without a task, its skin alone."""
    skin = shaded(mesh.vertices / MM_PER_M, mesh.triangles, SKIN, BASE_CREASE_DEG)
    children = [Node("skin", (skin,))]
    if task:
        marks = skin_marks(mesh, task.fiducials, task.labels)
        children.append(Node("rims", merged([mark.pop("rim") for mark in marks])))
        for label, mark in zip(task.labels, marks, strict=True):
            children += [Node(f"{kind}_{label}", (surface,)) for kind, surface in mark.items()]
    return Node("head", children=tuple(children))


def scene_glb(scenario: Scenario, robot: RobotModel, task: Task | None) -> bytes:
    """Return the GLB that docs/views.md describes; takes seconds, and imports VTK."""
    nodes = scene_nodes(scenario, robot, read_head_mesh(scenario.head), task)
    scene = trimesh.Scene(base_frame=ROOT)
    scene.graph.update(frame_from=ROOT, frame_to=WORLD, matrix=WORLD_TO_GLTF)
    for node in nodes:
        _add(scene, WORLD, node)
    return scene.export(file_type="glb", include_normals=True)


def scene_nodes(
    scenario: Scenario, robot: RobotModel, head: HeadMesh, task: Task | None
) -> list[Node]:
    """Return the nodes in World; moving nodes get their poses from the simulation's state."""
    base = (scenario.head_to_world @ np.append(head.base, 1.0))[:3] / MM_PER_M
    return [
        *robot_nodes(robot),
        head_node(head, task),
        stand_node(scenario.stand, base),
        table_node(scenario.table, scenario.stand, base),
        plan_node(scenario.procedures),
        *room_nodes(),
    ]


def main() -> int:
    """Build the given scene; if that is impossible, print one sentence and return 2."""
    with contextlib.suppress(AttributeError, OSError):
        os.nice(10)  # The control loop of the parent comes first.
    scenario, meshes, task, path = sys.argv[1:]
    try:
        setup = load_setup(Path(scenario), robot_meshes=Path(meshes) if meshes else None)
        chosen = setup.scenario.task(task) if task else None
        write_bytes(path, scene_glb(setup.scenario, setup.robot, chosen))
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
