"""The flat shapes of dots, rims and numbers, in the x-y plane, mm."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkFiltersModeling import vtkAdaptiveSubdivisionFilter
from vtkmodules.vtkFiltersSources import vtkDiskSource
from vtkmodules.vtkRenderingFreeType import vtkVectorText

from rastrainer_simulator.scene.surfaces import surface, triangles_of

DOT_RADIUS = 4.0
RIM_RADIUS = 5.2
NUMBER_HEIGHT = 11.0
LONGEST_EDGE = 1.5

Flat = tuple[np.ndarray, np.ndarray]
"""(n, 2) float points and (m, 3) int triangles."""


def dot() -> Flat:
    """Return a fiducial's colored disk."""
    return _disk(0.0, DOT_RADIUS)


def rim() -> Flat:
    """Return the pale ring around a fiducial's disk, reaching a little under it."""
    return _disk(DOT_RADIUS - 0.4, RIM_RADIUS)


def number(label: str) -> Flat:
    """Return a number, its middle at the origin, in pieces small enough to bend."""
    text = vtkVectorText()
    text.SetText(label)
    points, triangles = _flat(text)
    low, high = points.min(axis=0), points.max(axis=0)
    points = (points - (low + high) / 2.0) * NUMBER_HEIGHT / (high[1] - low[1])
    pieces = vtkAdaptiveSubdivisionFilter()
    upright = np.column_stack([points, np.zeros(len(points))])
    pieces.SetInputData(surface(upright, triangles))
    pieces.SetMaximumEdgeLength(LONGEST_EDGE)
    pieces.Update()
    return _counterclockwise(pieces.GetOutput())


def _disk(inner: float, outer: float) -> Flat:
    disk = vtkDiskSource()
    disk.SetInnerRadius(inner)
    disk.SetOuterRadius(outer)
    disk.SetRadialResolution(3)
    disk.SetCircumferentialResolution(32)
    return _flat(disk)


def _flat(source: vtkDiskSource | vtkVectorText) -> Flat:
    triangles = vtkTriangleFilter()
    triangles.SetInputConnection(source.GetOutputPort())
    triangles.Update()
    return _counterclockwise(triangles.GetOutput())


def _counterclockwise(made: vtkPolyData) -> Flat:
    """Return VTK's flat shape with all triangles turned to the viewer: text has some of each."""
    points = vtk_to_numpy(made.GetPoints().GetData())[:, :2].astype(float)
    triangles = triangles_of(made)
    (ax, ay), (bx, by) = ((points[triangles[:, i]] - points[triangles[:, 0]]).T for i in (1, 2))
    is_turned_away = ax * by - ay * bx < 0.0
    triangles[is_turned_away] = triangles[is_turned_away][:, ::-1]
    return points, triangles
