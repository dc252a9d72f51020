"""Flat shapes, and the head's surface that they are projected onto (a "shrinkwrap")."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import mutable, vtkIdList
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkStaticCellLocator, vtkStaticPointLocator
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkFiltersModeling import vtkAdaptiveSubdivisionFilter
from vtkmodules.vtkFiltersSources import vtkDiskSource
from vtkmodules.vtkRenderingFreeType import vtkVectorText

from rastrainer.head.mesh import HeadMesh
from rastrainer_simulator.scene.surfaces import surface, triangles_of

REACH = 25.0
PATCH_RADIUS = 10.0


@dataclass(frozen=True)
class Shape:
    """Triangles in the head's frame, RAS mm, or flat ones in the x-y plane.

    Attributes:
        points: (n, 3) float, mm.
        triangles: (m, 3) int, counterclockwise seen from outside.
        outward: (n, 3) float, unit normals of the skin below.
    """

    points: np.ndarray
    triangles: np.ndarray
    outward: np.ndarray


class Skin:
    """A head's surface; points and lengths in mm, RAS."""

    def __init__(self, head: HeadMesh) -> None:
        self._normals = head.vertex_normals
        shape = surface(head.vertices, head.triangles)
        self._cells, self._points = vtkStaticCellLocator(), vtkStaticPointLocator()
        for locator in (self._cells, self._points):
            locator.SetDataSet(shape)
            locator.BuildLocator()

    def outward(self, point: np.ndarray) -> np.ndarray:
        """Return the unit normal (3,) of the skin around a point, its wrinkles smoothed away."""
        near = vtkIdList()
        self._points.FindPointsWithinRadius(PATCH_RADIUS, point.tolist(), near)
        around = [near.GetId(index) for index in range(near.GetNumberOfIds())]
        normal = self._normals[around].sum(axis=0) if around else np.asarray(point, dtype=float)
        return normal / np.linalg.norm(normal)

    def frame(self, point: np.ndarray) -> np.ndarray:
        """Return (3, 3) float: right, up and outward at a point on the skin, as rows.

        Up is the patient's superior direction along the skin; at the crown, posterior.
        """
        outward = self.outward(point)
        up = np.array([0.0, 0.0, 1.0]) if abs(outward[2]) < 0.9 else np.array([0.0, -1.0, 0.0])
        up = up - (up @ outward) * outward
        up /= np.linalg.norm(up)
        return np.array([np.cross(up, outward), up, outward])

    def onto(self, points: np.ndarray, outward: np.ndarray) -> np.ndarray:
        """Return where lines through `points` (n, 3) along `outward` (3,) enter the skin, (n, 3).

        A point whose line misses the skin is not moved.
        """
        placed = points.tolist()
        hit, along, place = [0.0] * 3, mutable(0.0), [0.0] * 3
        part, cell = mutable(0), mutable(0)
        starts, ends = (points + REACH * outward).tolist(), (points - REACH * outward).tolist()
        for row, (start, end) in enumerate(zip(starts, ends, strict=True)):
            # VTK's stubs do not know `mutable`, by which Python gets numbers back.
            if self._cells.IntersectWithLine(  # type: ignore[call-overload]
                start, end, 1e-6, along, hit, place, part, cell
            ):
                placed[row] = tuple(hit)
        return np.array(placed)

    def lay(self, flat: np.ndarray, point: np.ndarray) -> np.ndarray:
        """Project flat points (n, 2) float around a point of the skin; return (n, 3) float."""
        frame = self.frame(point)
        return self.onto(point + flat @ frame[:2], frame[2])

    def lay_shape(self, points: np.ndarray, triangles: np.ndarray, at: np.ndarray) -> Shape:
        """Project a flat shape, (n, 2) float points and (m, 3) int triangles, around a point."""
        outward = self.frame(at)[2]
        return Shape(self.lay(points, at), triangles, np.tile(outward, (len(points), 1)))


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
