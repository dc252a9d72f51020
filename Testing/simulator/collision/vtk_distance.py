"""VTK's signed distance to a closed surface: what ours is compared with."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance


def vtk_distance(vertices: np.ndarray, triangles: np.ndarray) -> Callable[[Sequence[float]], float]:
    """Return a function from a point to its signed distance, below zero inside."""
    points = vtkPoints()
    points.SetDataTypeToDouble()
    points.SetData(numpy_to_vtk(vertices, deep=True))
    cells = vtkCellArray()
    corners = numpy_to_vtkIdTypeArray(triangles.astype(np.int64).ravel(), deep=True)
    starts = np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int64)
    cells.SetData(numpy_to_vtkIdTypeArray(starts, deep=True), corners)
    surface = vtkPolyData()
    surface.SetPoints(points)
    surface.SetPolys(cells)
    distance = vtkImplicitPolyDataDistance()
    distance.SetInput(surface)
    return distance.EvaluateFunction
