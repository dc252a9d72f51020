"""The head as nodes: its skin, and on it what guides the trainee through a task."""

from __future__ import annotations

from rastrainer.head_mesh import HeadMesh
from rastrainer.tasks import Task
from rastrainer_simulator.scene.materials import SKIN
from rastrainer_simulator.scene.nodes import Node, Surface

MM_IN_M = 1000.0


def head_node(mesh: HeadMesh, task: Task | None) -> Node:
    """Return the head in its own frame: RAS, but in m; without a task, its skin alone."""
    skin = Surface(mesh.vertices / MM_IN_M, mesh.vertex_normals, mesh.triangles, SKIN)
    return Node("head", children=(Node("skin", (skin,)),))
