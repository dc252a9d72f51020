"""Arrays as VTK's surfaces and back, smooth but for their sharp edges."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals

from rastrainer_simulator.scene.materials import Material
from rastrainer_simulator.scene.nodes import Surface


def surface(vertices: np.ndarray, triangles: np.ndarray) -> vtkPolyData:
    """Return a surface from (n, 3) float vertices and (m, 3) int triangles."""
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(vertices, dtype=np.float32), deep=True))
    corners = np.ascontiguousarray(triangles, dtype=np.int64).reshape(-1)
    cells = vtkCellArray()
    cells.SetData(3, numpy_to_vtkIdTypeArray(corners, deep=True))
    data = vtkPolyData()
    data.SetPoints(points)
    data.SetPolys(cells)
    return data


def vtk_matrix(matrix: np.ndarray) -> vtkMatrix4x4:
    """Return a (4, 4) float matrix as VTK's."""
    made = vtkMatrix4x4()
    made.DeepCopy(np.asarray(matrix, dtype=float).reshape(16).tolist())
    return made


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
