"""The head's surface, onto which flat shapes are laid (what Blender calls shrinkwrap)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from vtkmodules.vtkCommonCore import mutable, vtkIdList
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator, vtkStaticPointLocator

from rastrainer.head.mesh import HeadMesh
from rastrainer_simulator.scene.surfaces import surface

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

        A point whose line misses the skin stays where it is.
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
        """Lay flat points (n, 2) float around a point of the skin; return (n, 3) float."""
        frame = self.frame(point)
        return self.onto(point + flat @ frame[:2], frame[2])

    def lay_shape(self, points: np.ndarray, triangles: np.ndarray, at: np.ndarray) -> Shape:
        """Lay a flat shape, (n, 2) float points and (m, 3) int triangles, around a point."""
        outward = self.frame(at)[2]
        return Shape(self.lay(points, at), triangles, np.tile(outward, (len(points), 1)))
