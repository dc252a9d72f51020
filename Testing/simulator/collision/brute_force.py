"""Distances computed from every triangle, to check the fast computations."""

from collections.abc import Callable, Sequence

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance


def point_to_triangles(point: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return the distances (m,) of a point (3,) to triangles (m, 3, 3)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normals = np.cross(b - a, c - a)
    heights = _dot(point - a, normals) / np.linalg.norm(normals, axis=1)
    foot = point - (heights / np.linalg.norm(normals, axis=1))[:, None] * normals
    edges = [point_to_segments(point, u, v) for u, v in ((a, b), (b, c), (c, a))]
    return np.where(_is_within(foot, corners, normals), np.abs(heights), np.min(edges, axis=0))


def segment_to_triangles(start: np.ndarray, end: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return the distances (m,) of a segment to triangles (m, 3, 3), 0 if it goes through."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    distances = [point_to_triangles(start, corners), point_to_triangles(end, corners)]
    distances += [segment_to_segments(start, end, u, v) for u, v in ((a, b), (b, c), (c, a))]
    normals = np.cross(b - a, c - a)
    before, behind = _dot(start - a, normals), _dot(end - a, normals)
    crosses = before * behind < 0.0
    share = before / np.where(crosses, before - behind, 1.0)
    crosses &= _is_within(start + share[:, None] * (end - start), corners, normals)
    return np.where(crosses, 0.0, np.min(distances, axis=0))


def point_to_segments(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return the distances (m,) of a point (3,) to segments with ends (m, 3)."""
    axis = end - start
    share = np.clip(_dot(point - start, axis) / _dot(axis, axis), 0.0, 1.0)
    return np.linalg.norm(point - start - share[:, None] * axis, axis=1)


def segment_to_segments(
    p: np.ndarray, q: np.ndarray, start: np.ndarray, end: np.ndarray
) -> np.ndarray:
    """Return the distances (m,) of the segment p–q to segments with ends (m, 3).

    Either an end is nearest, or the lines' common perpendicular ends inside both.
    """
    ends = [point_to_segments(p, start, end), point_to_segments(q, start, end)]
    ends += [_points_to_segment(start, p, q), _points_to_segment(end, p, q)]
    u, v = q - p, end - start
    across = np.cross(u, v)
    size = _dot(across, across)
    skew = size > 1e-24
    size = np.where(skew, size, 1.0)
    on_first = _dot(np.cross(start - p, v), across) / size
    on_second = _dot(np.cross(start - p, u), across) / size
    inside = skew & (on_first >= 0) & (on_first <= 1) & (on_second >= 0) & (on_second <= 1)
    between = np.abs(_dot(start - p, across)) / np.sqrt(size)
    return np.where(inside, between, np.min(ends, axis=0))


def _points_to_segment(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    axis = end - start
    share = np.clip((points - start) @ axis / (axis @ axis), 0.0, 1.0)
    return np.linalg.norm(points - start - share[:, None] * axis, axis=1)


def _is_within(points: np.ndarray, corners: np.ndarray, normals: np.ndarray) -> np.ndarray:
    sides = [
        _dot(np.cross(corners[:, (k + 1) % 3] - corners[:, k], points - corners[:, k]), normals)
        for k in range(3)
    ]
    return np.min(sides, axis=0) >= 0.0


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.einsum("...i,...i->...", a, b)


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
