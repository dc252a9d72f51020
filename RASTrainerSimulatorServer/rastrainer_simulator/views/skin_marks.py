"""Dots and numbers that follow the skin: flat shapes laid onto the head along its normal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import mutable
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkStaticCellLocator
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkFiltersModeling import vtkAdaptiveSubdivisionFilter
from vtkmodules.vtkFiltersSources import vtkDiskSource
from vtkmodules.vtkRenderingFreeType import vtkVectorText

from rastrainer.head_mesh import HeadMesh
from rastrainer_simulator.views.actors import surface

DOT_RADIUS = 4.0
RIM_RADIUS = 5.2
NUMBER_HEIGHT = 11.0
NUMBER_DISTANCE = 13.5
ROOM_ENOUGH = 30.0
REACH = 25.0
RIM_LIFT, DOT_LIFT, NUMBER_LIFT = 0.5, 0.8, 0.6
PATCH_RADIUS = 10.0


@dataclass(frozen=True)
class SkinMark:
    """One fiducial's marks, surfaces in the head's frame (RAS mm)."""

    label: str
    dot: vtkPolyData
    rim: vtkPolyData
    number: vtkPolyData


def skin_marks(head: HeadMesh, points: np.ndarray, labels: Sequence[str]) -> list[SkinMark]:
    """Return the marks of fiducials at `points` (n, 3) float, RAS mm.

    A number stands beside its dot, on the side where it is farthest from all other marks.
    """
    skin = _Skin(head)
    places = _number_places(skin, points)
    marks = []
    for point, place, label in zip(points, places, labels, strict=True):
        marks.append(
            SkinMark(
                label,
                skin.lay(_disk(0.0, DOT_RADIUS), point, DOT_LIFT),
                skin.lay(_disk(DOT_RADIUS - 0.4, RIM_RADIUS), point, RIM_LIFT),
                skin.lay(_number(label), place, NUMBER_LIFT),
            )
        )
    return marks


class _Skin:
    """The head's surface, onto which flat shapes are laid."""

    def __init__(self, head: HeadMesh):
        self._vertices = head.vertices
        self._normals = head.vertex_normals
        self._locator = vtkStaticCellLocator()
        self._locator.SetDataSet(surface(head.vertices, head.triangles))
        self._locator.BuildLocator()

    def frame(self, point: np.ndarray) -> np.ndarray:
        """Return (3, 3) float: right, up and outward at a point on the skin, as rows.

        Up is the patient's superior direction along the skin; at the crown, posterior.
        """
        near = np.linalg.norm(self._vertices - point, axis=1) < PATCH_RADIUS
        outward = self._normals[near].sum(axis=0) if near.any() else point
        outward = outward / np.linalg.norm(outward)
        up = np.array([0.0, 0.0, 1.0]) if abs(outward[2]) < 0.9 else np.array([0.0, -1.0, 0.0])
        up = up - (up @ outward) * outward
        up /= np.linalg.norm(up)
        return np.array([np.cross(up, outward), up, outward])

    def lay(self, shape: vtkPolyData, point: np.ndarray, lift: float) -> vtkPolyData:
        """Lay a flat shape (in the x-y plane, mm) onto the skin around a point."""
        frame = self.frame(point)
        flat = vtk_to_numpy(shape.GetPoints().GetData()).astype(float)
        laid = np.array([self.onto(point + corner[:2] @ frame[:2], frame[2]) for corner in flat])
        triangles = vtk_to_numpy(shape.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        return surface(laid + lift * frame[2], triangles)

    def onto(self, point: np.ndarray, outward: np.ndarray) -> np.ndarray:
        """Return where the line through `point` along `outward` enters the skin, else `point`."""
        start, end = point + REACH * outward, point - REACH * outward
        hit, place = [0.0, 0.0, 0.0], mutable(0.0)
        found = self._locator.IntersectWithLine(
            start, end, 1e-6, place, hit, [0.0] * 3, mutable(0), mutable(0)
        )
        return np.array(hit) if found else point


def _number_places(skin: _Skin, points: np.ndarray) -> list[np.ndarray]:
    """Return where each number's middle comes: on the emptiest side of its dot."""
    places: list[np.ndarray] = []
    for index, point in enumerate(points):
        frame = skin.frame(point)
        others = np.vstack([np.delete(points, index, axis=0), *(place[None] for place in places)])
        angles = np.radians(np.arange(0, 360, 45))
        sides = [
            skin.onto(
                point + NUMBER_DISTANCE * (np.cos(a) * frame[0] + np.sin(a) * frame[1]), frame[2]
            )
            for a in angles
        ]
        room = [np.linalg.norm(others - side, axis=1).min(initial=ROOM_ENOUGH) for side in sides]
        places.append(sides[int(np.argmax(room))])
    return places


def _disk(inner: float, outer: float) -> vtkPolyData:
    disk = vtkDiskSource()
    disk.SetInnerRadius(inner)
    disk.SetOuterRadius(outer)
    disk.SetRadialResolution(3)
    disk.SetCircumferentialResolution(32)
    return _triangles(disk)


def _number(label: str) -> vtkPolyData:
    """Return a number's shape, its middle at the origin, in pieces small enough to bend."""
    text = vtkVectorText()
    text.SetText(label)
    whole = _triangles(text)
    low_x, high_x, low_y, high_y, _, _ = whole.GetBounds()
    points = vtk_to_numpy(whole.GetPoints().GetData()).astype(float)
    scale = NUMBER_HEIGHT / (high_y - low_y)
    points = (points - [(low_x + high_x) / 2, (low_y + high_y) / 2, 0.0]) * scale
    triangles = vtk_to_numpy(whole.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    pieces = vtkAdaptiveSubdivisionFilter()
    pieces.SetInputData(surface(points, triangles))
    pieces.SetMaximumEdgeLength(1.5)
    pieces.Update()
    return pieces.GetOutput()


def _triangles(source: vtkDiskSource | vtkVectorText) -> vtkPolyData:
    triangles = vtkTriangleFilter()
    triangles.SetInputConnection(source.GetOutputPort())
    triangles.Update()
    return triangles.GetOutput()
