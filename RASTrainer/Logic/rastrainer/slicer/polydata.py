"""Arrays as VTK's data: surfaces, clouds of points, and the values at their points."""

from __future__ import annotations

from typing import Any

import numpy as np
import vtk

from rastrainer.head.mesh import HeadMesh


def vtkArray(values: np.ndarray, name: str = "") -> Any:
    """Return a copy of numbers (n,) or (n, k) as an array of VTK's."""
    from vtk.util.numpy_support import numpy_to_vtk

    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    return array


def trianglesPolyData(
    points: np.ndarray, triangles: np.ndarray, normals: np.ndarray | None = None
) -> vtk.vtkPolyData:
    """Return a surface of points (n, 3), triangles (m, 3) int, and unit normals (n, 3)."""
    surface = vtk.vtkPolyData(points=_points(points), polys=_cells(triangles))
    if normals is not None:
        surface.GetPointData().SetNormals(vtkArray(normals.astype(np.float32), "Normals"))
    return surface


def meshPolyData(mesh: HeadMesh) -> vtk.vtkPolyData:
    return trianglesPolyData(mesh.vertices, mesh.triangles, mesh.vertex_normals)


def pointCloud(places: np.ndarray) -> vtk.vtkPolyData:
    """Return places (n, 3) as points, each of them a vertex cell."""
    return vtk.vtkPolyData(points=_points(places), verts=_cells(np.arange(len(places))[:, None]))


def _points(places: np.ndarray) -> vtk.vtkPoints:
    return vtk.vtkPoints(data=vtkArray(places.astype(np.float32)))


def _cells(corners: np.ndarray) -> vtk.vtkCellArray:
    """Return cells of equal size, (n, k) int."""
    from vtk.util.numpy_support import numpy_to_vtkIdTypeArray

    cells = vtk.vtkCellArray()
    rows = np.ascontiguousarray(corners, dtype=np.int64).ravel()
    cells.SetData(corners.shape[1], numpy_to_vtkIdTypeArray(rows, deep=True))
    return cells
