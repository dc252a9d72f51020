"""One scene as a GLB file, made of a scenario, a robot and a task.

Run as a short-lived process, since VTK would stop the control loop's, it reads one JSON object from
standard input: `scenario` and `robotMeshes` (folders, null for the meshes that come with
RASTrainer), `task` (a name, or "" for none) and `path` (the file to write).
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
import uuid
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
from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.procedure.plan import Procedure, read_no_go_mesh
from rastrainer.scenario.points import Task
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.robot.meshes import load_meshes
from rastrainer_simulator.robot.model import RobotLink, RobotModel
from rastrainer_simulator.scene.nodes import (
    ARROW,
    AXIS,
    DRILL,
    ELECTRODE,
    GUIDE,
    MARK_RIM,
    NO_GO,
    NUMBER,
    SKIN,
    TIP_FREE,
    TIP_MARKER,
    TOOL,
    WAITING,
    Material,
    Node,
    Surface,
    link_node_name,
    merged,
    no_go_name,
    painted,
)
from rastrainer_simulator.scene.room_nodes import room_nodes, stand_node, table_node
from rastrainer_simulator.scene.skin import Shape
from rastrainer_simulator.scene.skin_marks import SkinMark, skin_marks
from rastrainer_simulator.scene.surfaces import shaded, turned


def robot_nodes(robot: RobotModel) -> list[Node]:
    """Return the nodes of a robot, each in the frame that the stream moves.

    What is fixed behind the flange is the tool; its node's origin is the tool's tip.
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
    return [*nodes, Node(TOOL, merged(surfaces[TOOL]), (tip_marker, *_instrument_nodes()))]


def _first_links(robot: RobotModel) -> dict[int, RobotLink]:
    """Return the link whose pose is in the state, for each number of joints before it."""
    first: dict[int, RobotLink] = {}
    for link in robot.links:
        first.setdefault(link.joint, link)
    return first


PLAN = "plan"
SLEEVE_LENGTH, SLEEVE_RADIUS, MOUTH_RADIUS = 0.075, 0.0065, 0.0035
AXIS_LENGTH, AXIS_RADIUS = 0.2, 0.00035
DRILL_RADIUS, ELECTRODE_RADIUS = 0.0016, 0.0011
"""As drawn; an electrode is mostly thinner, and would be hardly visible."""


def _instrument_nodes() -> tuple[Node, ...]:
    """Return what the tool holds in a procedure; its frame's origin is the tip, z is the axis.

    `drill` and `electrode` are 1 m long: a view scales them along z by how far they are fed.
    """
    sleeve = [
        (SLEEVE_RADIUS, -SLEEVE_LENGTH),
        (SLEEVE_RADIUS, -0.2 * SLEEVE_LENGTH),
        (MOUTH_RADIUS, 0.0),
    ]
    axis = [(AXIS_RADIUS, 0.0), (AXIS_RADIUS, AXIS_LENGTH)]
    drill = [(DRILL_RADIUS, 0.0), (DRILL_RADIUS, 1.0)]
    electrode = [(ELECTRODE_RADIUS, 0.0), (ELECTRODE_RADIUS, 1.0)]
    made = (
        ("guide", sleeve, GUIDE),
        ("axis", axis, AXIS),
        ("drill", drill, DRILL),
        ("electrode", electrode, ELECTRODE),
    )
    return tuple(
        Node(name, (turned(0.0, 0.0, profile, material),), is_hidden=True)
        for name, profile, material in made
    )


def plan_node(procedures: Sequence[Procedure]) -> Node:
    """Return the node that the stream puts where a registration has the MRI: RAS, but in m.

    Its children are the no-go structures of all procedures, one for each file.
    """
    files = sorted({each.file for procedure in procedures for each in procedure.no_go})
    return Node(PLAN, children=tuple(_no_go_node(path) for path in files))


def _no_go_node(path: Path) -> Node:
    mesh = read_no_go_mesh(path)
    surface = shaded(mesh.vertices / MM_PER_M, mesh.triangles, NO_GO)
    return Node(no_go_name(path), (surface,), is_hidden=True)


ROOT = "scene"
WORLD = "world"
# glTF's y is up, as World's z is; x stays.
WORLD_TO_GLTF = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], dtype=float)


def to_glb(nodes: list[Node]) -> bytes:
    """Return the GLB of nodes in World.

    A node of one surface carries it; one of several has a child for each, named `NODE_MATERIAL`.
    """
    scene = trimesh.Scene(base_frame=ROOT)
    scene.graph.update(frame_from=ROOT, frame_to=WORLD, matrix=WORLD_TO_GLTF)
    materials: dict[Material, PBRMaterial] = {}
    for node in nodes:
        _add(scene, WORLD, node, materials)
    return scene.export(file_type="glb", include_normals=True)


def _add(
    scene: trimesh.Scene, parent: str, node: Node, materials: dict[Material, PBRMaterial]
) -> None:
    pose = np.eye(4) if node.pose is None else node.pose
    single = node.surfaces[0] if len(node.surfaces) == 1 else None
    if single is not None:
        _add_surface(scene, parent, node.name, pose, single, materials)
    else:
        scene.graph.update(frame_from=parent, frame_to=node.name, matrix=pose)
        for surface in node.surfaces:
            name = f"{node.name}_{surface.material.name}"
            _add_surface(scene, node.name, name, np.eye(4), surface, materials)
    for child in node.children:
        _add(scene, node.name, child, materials)


def _add_surface(
    scene: trimesh.Scene,
    parent: str,
    name: str,
    pose: np.ndarray,
    surface: Surface,
    materials: dict[Material, PBRMaterial],
) -> None:
    if surface.material not in materials:
        materials[surface.material] = _material(surface.material)
    mesh = trimesh.Trimesh(
        surface.vertices,
        surface.triangles,
        vertex_normals=surface.normals,
        visual=TextureVisuals(material=materials[surface.material]),
        process=False,
    )
    scene.add_geometry(
        mesh, node_name=name, geom_name=name, parent_node_name=parent, transform=pose
    )


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


BASE_CREASE_DEG = 60.0
"""The rim of the flat base is sharper than this; nothing of a face is."""


def head_node(mesh: HeadMesh, task: Task | None) -> Node:
    """Return the head in its own frame: RAS, but in m; without a task, its skin alone."""
    skin = shaded(mesh.vertices / MM_PER_M, mesh.triangles, SKIN, BASE_CREASE_DEG)
    marks = skin_marks(mesh, task.fiducials, task.labels) if task else []
    rims = Node("rims", merged([_surface(mark.rim, MARK_RIM) for mark in marks]))
    children = [Node("skin", (skin,)), *([rims] if marks else [])]
    for mark in marks:
        children.extend(_mark_nodes(mark))
    return Node("head", children=tuple(children))


def _mark_nodes(mark: SkinMark) -> list[Node]:
    nodes = [
        Node(f"fiducial_{mark.label}", (_surface(mark.dot, WAITING),)),
        Node(f"number_{mark.label}", (_surface(mark.number, NUMBER),)),
    ]
    if mark.arrow is not None:
        nodes.append(Node(f"arrow_{mark.label}", (_surface(mark.arrow, ARROW),)))
    return nodes


def _surface(shape: Shape, material: Material) -> Surface:
    return Surface(shape.points / MM_PER_M, shape.outward, shape.triangles, material)


def scene_glb(scenario: Scenario, robot: RobotModel, task: Task | None) -> bytes:
    """Return the GLB that docs/views.md describes; takes seconds, and imports VTK."""
    return to_glb(scene_nodes(scenario, robot, read_head_mesh(scenario.head_mesh), task))


def scene_nodes(
    scenario: Scenario, robot: RobotModel, head: HeadMesh, task: Task | None
) -> list[Node]:
    """Return the nodes in World; moving nodes get their poses from the simulation's state."""
    base = (scenario.head_to_world @ np.append(head.base, 1.0))[:3] / MM_PER_M
    return [
        *robot_nodes(robot),
        head_node(head, task),
        stand_node(scenario.furniture, base),
        table_node(scenario.furniture, base),
        plan_node(scenario.procedures),
        *room_nodes(),
    ]


def main() -> int:
    """Build the given scene; if that is impossible, print one sentence and return 2."""
    with contextlib.suppress(AttributeError, OSError):
        os.nice(10)  # The control loop of the parent comes first.
    wanted = json.load(sys.stdin)
    meshes, task = wanted["robotMeshes"], wanted["task"]
    try:
        setup = load_setup(Path(wanted["scenario"]), robot_meshes=meshes and Path(meshes))
        chosen = setup.scenario.task(task) if task else None
        _write(Path(wanted["path"]), scene_glb(setup.scenario, setup.robot, chosen))
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


def _write(path: Path, content: bytes) -> None:
    """Write a file whole or not at all: others may build the same one at the same time."""
    partial = path.with_name(f"{uuid.uuid4().hex}.partial")
    try:
        partial.write_bytes(content)
        partial.replace(path)
    except OSError as error:
        with contextlib.suppress(OSError):
            partial.unlink()
        raise InputError(f"The scene {path} cannot be written: {error.strerror}.") from error


if __name__ == "__main__":
    sys.exit(main())
