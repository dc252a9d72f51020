"""Arrays as VTK's surfaces and back, smooth except at sharp edges; solids for furniture, in m."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals

from rastrainer_simulator.scene.nodes import Material, Surface

ROUND = 40
_CORNER = 5

Span = tuple[float, float]


def box(x: Span, y: Span, z: Span, material: Material) -> Surface:
    ring = np.array([(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])])
    return _stack([(ring, z[0]), (ring, z[1])], material)


def soft_box(
    x: Span, y: Span, z: Span, material: Material, radius: float = 0.02, edge: float = 0.006
) -> Surface:
    """Return a box with round upright edges of a `radius`, the others beveled by `edge`."""
    outer, inner = _rounded(x, y, radius, 0.0), _rounded(x, y, radius, edge)
    low, high = z
    rings = [(inner, low), (outer, low + edge), (outer, high - edge), (inner, high)]
    return _stack(rings, material)


def post(x: float, y: float, z: Span, radius: float, material: Material) -> Surface:
    return turned(x, y, [(radius, z[0]), (radius, z[1])], material)


def turned(
    x: float,
    y: float,
    profile: Sequence[tuple[float, float]],
    material: Material,
    pose: np.ndarray | None = None,
) -> Surface:
    """Return what a lathe makes: `profile` has radius and height, from below upward.

    `pose` (4, 4) float moves it from its upright pose.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, ROUND, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    rings = [(circle * radius + (x, y), height) for radius, height in profile]
    return _stack(rings, material, pose)


def _rounded(x: Span, y: Span, radius: float, inset: float) -> np.ndarray:
    """Return a rectangle with round corners, moved inward by `inset`: (n, 2) float."""
    bend = max(radius - inset, 1e-4)
    quarter = np.linspace(0.0, np.pi / 2.0, _CORNER)
    centers = [
        (x[1] - radius, y[1] - radius),
        (x[0] + radius, y[1] - radius),
        (x[0] + radius, y[0] + radius),
        (x[1] - radius, y[0] + radius),
    ]
    corners = []
    for index, center in enumerate(centers):
        angles = quarter + index * np.pi / 2.0
        corners.append(np.column_stack([np.cos(angles), np.sin(angles)]) * bend + center)
    return np.concatenate(corners)


def _stack(
    rings: Sequence[tuple[np.ndarray, float]], material: Material, pose: np.ndarray | None = None
) -> Surface:
    """Return the solid through rings (n, 2) at rising heights, each counterclockwise and convex."""
    count = len(rings[0][0])
    points = [np.column_stack([ring, np.full(count, height)]) for ring, height in rings]
    vertices, triangles = stitched(np.array(points))
    if pose is not None:
        vertices = vertices @ pose[:3, :3].T + pose[:3, 3]
    return shaded(vertices, triangles, material)


def stitched(rings: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Join rings (levels, count, 3) float into a closed shell, a fan over either end.

    Return vertices (n, 3) and triangles (m, 3).
    """
    levels, count, _ = rings.shape
    vertices = np.vstack([rings.reshape(-1, 3), rings[0].mean(axis=0), rings[-1].mean(axis=0)])
    here = np.arange(count)
    following = np.roll(here, -1)
    triangles = []
    for level in range(levels - 1):
        below, above = level * count, (level + 1) * count
        triangles.append(np.column_stack([below + here, below + following, above + following]))
        triangles.append(np.column_stack([below + here, above + following, above + here]))
    top = (levels - 1) * count
    bottom_middle, top_middle = len(vertices) - 2, len(vertices) - 1
    triangles.append(np.column_stack([following, here, np.full(count, bottom_middle)]))
    triangles.append(np.column_stack([top + here, top + following, np.full(count, top_middle)]))
    return vertices, np.concatenate(triangles)


def surface(
    vertices: np.ndarray, triangles: np.ndarray, normals: np.ndarray | None = None
) -> vtkPolyData:
    """Return a surface from vertices and normals (n, 3) float and triangles (m, 3) int."""
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(vertices, dtype=np.float32), deep=True))
    corners = np.ascontiguousarray(triangles, dtype=np.int64).reshape(-1)
    cells = vtkCellArray()
    cells.SetData(3, numpy_to_vtkIdTypeArray(corners, deep=True))
    data = vtkPolyData()
    data.SetPoints(points)
    data.SetPolys(cells)
    if normals is not None:
        directions = np.ascontiguousarray(normals, dtype=np.float32)
        data.GetPointData().SetNormals(numpy_to_vtk(directions, deep=True))
    return data


def vtk_matrix(matrix: np.ndarray) -> vtkMatrix4x4:
    made = vtkMatrix4x4()
    made.DeepCopy(np.asarray(matrix, dtype=float).reshape(16).tolist())
    return made


CREASE_DEG = 22.0


def shaded(
    vertices: np.ndarray, triangles: np.ndarray, material: Material, crease_deg: float = CREASE_DEG
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
