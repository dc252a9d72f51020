"""Turn arrays into what VTK draws."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkCommonMath import vtkMatrix4x4


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
