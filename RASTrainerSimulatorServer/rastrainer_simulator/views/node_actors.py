"""Turn a scene's nodes into VTK actors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

from rastrainer_simulator.scene.materials import Material
from rastrainer_simulator.scene.nodes import Node, Surface
from rastrainer_simulator.views.actors import surface, vtk_matrix
from rastrainer_simulator.views.materials import apply_material


def node_actors(
    nodes: Sequence[Node], poses: Mapping[str, np.ndarray], looks: Mapping[str, Material]
) -> list[vtkActor]:
    """Return the actors of nodes that stand in World.

    `poses` has a (4, 4) float pose in World, m, by the name of each node that is moved; `looks` a
    material by the name of each node that has another color than in the scene.
    """
    actors = []
    for node in nodes:
        pose = poses.get(node.name, np.eye(4))
        for part in node.walk():
            for shape in part.surfaces:
                actors.append(_actor(shape, looks.get(part.name, shape.material), pose))
    return actors


def _actor(shape: Surface, material: Material, pose: np.ndarray) -> vtkActor:
    data = surface(shape.vertices, shape.triangles)
    normals = np.ascontiguousarray(shape.normals, dtype=np.float32)
    data.GetPointData().SetNormals(numpy_to_vtk(normals, deep=True))
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.ScalarVisibilityOff()
    made = vtkActor()
    made.SetMapper(mapper)
    made.SetUserMatrix(vtk_matrix(pose))
    apply_material(material, made.GetProperty())
    return made
