"""Surfaces that are smooth but for their sharp edges."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals

from rastrainer_simulator.scene.materials import Material
from rastrainer_simulator.scene.nodes import Surface
from rastrainer_simulator.views.actors import surface

CREASE_DEG = 22.0


def shaded(
    vertices: np.ndarray,
    triangles: np.ndarray,
    material: Material,
    crease_deg: float = CREASE_DEG,
) -> Surface:
    """Return (n, 3) float vertices, m, and (m, 3) int triangles with their normals.

    Where two triangles meet at more than `crease_deg`, the edge stays sharp.
    """
    normals = vtkPolyDataNormals()
    normals.SetInputData(surface(vertices, triangles))
    normals.SetFeatureAngle(crease_deg)
    normals.ConsistencyOff()
    normals.Update()
    made = normals.GetOutput()
    return Surface(
        vtk_to_numpy(made.GetPoints().GetData()).astype(float),
        vtk_to_numpy(made.GetPointData().GetNormals()).astype(float),
        triangles_of(made),
        material,
    )


def triangles_of(data: vtkPolyData) -> np.ndarray:
    """Return the triangles (m, 3) int of VTK's surface, which must hold nothing else."""
    return vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3).astype(np.int64)
