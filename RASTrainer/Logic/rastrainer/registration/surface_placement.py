"""Where several starts of a fit put the points, and their nearest points on the surface."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from rastrainer.head.mesh import HeadMesh


@dataclass(frozen=True)
class SurfaceFit:
    """Where each of s starts ended, with n points.

    Attributes:
        matrices: (s, 4, 4) float, World→RAS, mm.
        distances_mm: (s, n) float, to the surface.
        nearest_mm: (s, n, 3) float, RAS, the nearest points.
        triangles: (s, n) int, which they lie on.
        converged: (s,) bool.
        iterations: (s,) int.
    """

    matrices: np.ndarray
    distances_mm: np.ndarray
    nearest_mm: np.ndarray
    triangles: np.ndarray
    converged: np.ndarray
    iterations: np.ndarray

    def taken(self, rows: np.ndarray) -> SurfaceFit:
        """Return the fit of some of the starts."""
        return SurfaceFit(*(getattr(self, field.name)[rows] for field in fields(self)))

    def joined(self, other: SurfaceFit) -> SurfaceFit:
        """Return these fits and others of the same points."""
        pairs = ((getattr(one, field.name) for one in (self, other)) for field in fields(self))
        return SurfaceFit(*(np.concatenate(list(pair)) for pair in pairs))


def plane_normals(mesh: HeadMesh, fit: SurfaceFit, points: np.ndarray) -> np.ndarray:
    """Return the unit directions (s, n, 3) in which the distances grow.

    It is the line from the nearest point; for a point on the surface, the triangle's normal.
    """
    offsets = transforms_of(fit.matrices, points) - fit.nearest_mm
    distances = fit.distances_mm[..., None]
    normals = offsets / np.where(distances > 0.0, distances, 1.0)
    close = np.nonzero(fit.distances_mm < 1e-6)
    if len(close[0]):
        normals[close] = mesh.triangle_normals[fit.triangles[close]]
    return normals


def transforms_of(matrices: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return points (n, 3) mapped by each of the matrices (s, 4, 4), (s, n, 3) float."""
    return points @ np.swapaxes(matrices[:, :3, :3], 1, 2) + matrices[:, None, :3, 3]


def rotations(vectors: np.ndarray) -> np.ndarray:
    """Return the rotations (s, 3, 3) about vectors (s, 3) by their lengths in rad (Rodrigues)."""
    angles = np.linalg.norm(vectors, axis=1)
    cross = cross_products(vectors[:, None, :], np.eye(3))
    safe = np.where(angles > 1e-12, angles, 1.0)
    first = np.where(angles > 1e-12, np.sin(safe) / safe, 1.0)
    second = np.where(angles > 1e-12, (1.0 - np.cos(safe)) / safe**2, 0.5)
    # np.cross(v, e) has the columns of [v]× as its rows.
    cross = np.swapaxes(cross, 1, 2)
    return np.eye(3) + first[:, None, None] * cross + second[:, None, None] * cross @ cross


def cross_products(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the cross products (…, 3), for few at a time faster than numpy's."""
    (a, b, c), (x, y, z) = np.moveaxis(one, -1, 0), np.moveaxis(other, -1, 0)
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=-1)
