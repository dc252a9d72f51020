"""Starts on both sides of a fit, since a head made of triangles has many minima close together.

Minima whose costs hardly differ lie where the points determine the pose least. So a fit is repeated
from both sides, along the direction of least curvature, and the lowest is taken.
"""

from __future__ import annotations

import numpy as np

from rastrainer.head.mesh import HeadMesh
from rastrainer.registration.surface_fit import (
    SurfaceFit,
    gates,
    plane_normals,
    rotations,
    transforms_of,
)

DIRECTIONS = 1
ASIDE_SD = 1.0
"""How far aside, in standard deviations of the pose as the residuals tell it."""
ASIDE_MM = 2.0
"""How far aside at most, at the trace."""


def starts_aside(points: np.ndarray, mesh: HeadMesh, fit: SurfaceFit, row: int) -> np.ndarray:
    """Return starts (2k, 4, 4) aside of one of several fits, along k directions.

    Args:
        points: (n, 3) float, World mm, those of the fits.
        mesh: The surface, RAS mm.
        fit: The fits.
        row: Which one.
    """
    one = fit.taken(np.array([row]))
    counts = one.distances_mm[0] <= gates(one.distances_mm)[0]
    places = transforms_of(one.matrices, points)[0]
    center = places.mean(axis=0)
    extent = float(np.sqrt(np.mean(np.sum((places - center) ** 2, axis=1))))
    normals = plane_normals(mesh, one, points)[0][counts]
    rows = np.concatenate([normals, np.cross(places[counts] - center, normals) / extent], axis=1)
    curvature, axes = np.linalg.eigh(rows.T @ rows)
    variance = np.mean(one.distances_mm[0][counts] ** 2) / np.maximum(curvature, 1e-9)
    sizes = np.minimum(ASIDE_SD * np.sqrt(variance[:DIRECTIONS]), ASIDE_MM)
    steps = (axes[:, :DIRECTIONS] * sizes).T
    steps = np.concatenate([steps, -steps])
    moved = np.tile(np.eye(4), (len(steps), 1, 1))
    moved[:, :3, :3] = rotations(steps[:, 3:] / extent)
    moved[:, :3, 3] = center - moved[:, :3, :3] @ center + steps[:, :3]
    return np.asarray(moved @ one.matrices[0])
