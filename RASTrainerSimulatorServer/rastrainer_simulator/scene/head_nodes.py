"""The head as nodes: its skin, and on it what guides the trainee through a task."""

from __future__ import annotations

from rastrainer.head_mesh import HeadMesh
from rastrainer.tasks import Task
from rastrainer_simulator.scene.materials import ARROW, MARK_RIM, NUMBER, SKIN, WAITING, Material
from rastrainer_simulator.scene.nodes import Node, Surface, merged
from rastrainer_simulator.scene.shading import shaded
from rastrainer_simulator.scene.skin import Shape
from rastrainer_simulator.scene.skin_marks import SkinMark, skin_marks

MM_IN_M = 1000.0
BASE_CREASE_DEG = 60.0
"""The rim of the flat base is sharper than this; nothing of a face is."""


def head_node(mesh: HeadMesh, task: Task | None) -> Node:
    """Return the head in its own frame: RAS, but in m; without a task, its skin alone."""
    skin = shaded(mesh.vertices / MM_IN_M, mesh.triangles, SKIN, BASE_CREASE_DEG)
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
    return Surface(shape.points / MM_IN_M, shape.outward, shape.triangles, material)
