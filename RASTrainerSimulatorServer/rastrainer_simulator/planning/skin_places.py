"""Places of the skin where a fiducial can be: smooth, clear of the base, spread evenly."""

from __future__ import annotations

import numpy as np

from rastrainer.head_mesh import HeadMesh

ABOVE_BASE_MM = 25.0
SMOOTH_WITHIN_MM = 12.0
MOST_BENDING_DEG = 30.0
"""Within that distance no normal may differ more: no ears, nostrils, eyelids, brows."""

DOWNWARD = -0.4
"""A place whose normal points farther down than this (its S) cannot be seen or touched well."""


def smooth_places(mesh: HeadMesh, spacing_mm: float) -> np.ndarray:
    """Return the indices (n,) of vertices where the skin is smooth, `spacing_mm` from each other.

    The same mesh gives the same places.
    """
    height = mesh.vertices[:, 2] - mesh.vertices[:, 2].min()
    allowed = (height > ABOVE_BASE_MM) & (mesh.vertex_normals[:, 2] > DOWNWARD)
    allowed = np.flatnonzero(allowed)
    spread = spread_out(mesh.vertices[allowed], spacing_mm)
    return np.array([vertex for vertex in allowed[spread] if is_smooth(mesh, vertex)])


def is_smooth(mesh: HeadMesh, vertex: int) -> bool:
    """Tell whether the skin around a vertex bends little."""
    away = np.linalg.norm(mesh.vertices - mesh.vertices[vertex], axis=1)
    around = mesh.vertex_normals[away < SMOOTH_WITHIN_MM]
    least = np.cos(np.radians(MOST_BENDING_DEG))
    return bool((around @ mesh.vertex_normals[vertex]).min() >= least)


def spread_out(points: np.ndarray, spacing_mm: float) -> list[int]:
    """Return indices of points (n, 3), each the farthest from those before, at least so far."""
    chosen = [int(points[:, 2].argmax())]
    nearest = np.linalg.norm(points - points[chosen[0]], axis=1)
    while nearest.max() >= spacing_mm:
        chosen.append(int(nearest.argmax()))
        nearest = np.minimum(nearest, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return chosen
