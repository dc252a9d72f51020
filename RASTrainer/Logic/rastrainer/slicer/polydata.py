"""Triangles and arrows as VTK data."""

from __future__ import annotations

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray


def trianglesPolyData(vertices: np.ndarray, triangles: np.ndarray) -> vtk.vtkPolyData:
    """Return a surface with smooth normals.

    Args:
        vertices: (n, 3) float.
        triangles: (m, 3) int, counterclockwise seen from outside.
    """
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(vertices, dtype=np.float32), deep=True))
    corners = np.ascontiguousarray(triangles, dtype=np.int64).ravel()
    cells = vtk.vtkCellArray()
    cells.SetData(3, numpy_to_vtkIdTypeArray(corners, deep=True))
    surface = vtk.vtkPolyData()
    surface.SetPoints(points)
    surface.SetPolys(cells)
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputData(surface)
    normals.SplittingOff()
    normals.ConsistencyOff()
    normals.Update()
    return normals.GetOutput()
