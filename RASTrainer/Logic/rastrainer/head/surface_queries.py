"""Nearest points, outward normals and visibility on a surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.head.mesh import HeadMesh

POINTS_AT_ONCE = 8
"""Their distances to all vertices fit into a processor's cache; numpy's library for matrices would
begin threads for many more, which take longer to start than this takes."""


@dataclass(frozen=True)
class NearestPoint:
    """The point of a surface nearest to a given one; mm.

    Attributes:
        position: (3,) float.
        distance: to the given point.
        triangle: index of the triangle that it lies on.
        weights: (3,) float, its barycentric coordinates there.
    """

    position: np.ndarray
    distance: float
    triangle: int
    weights: np.ndarray


def nearest_on_mesh(mesh: HeadMesh, point: np.ndarray) -> NearestPoint:
    """Return the point of the surface nearest to `point` (3,)."""
    centers, radii = mesh.triangle_spheres
    to_centers = np.linalg.norm(centers - point, axis=1)
    near = np.flatnonzero(to_centers - radii <= (to_centers + radii).min())
    corners = mesh.vertices[mesh.triangles[near]]
    weights = _nearest_weights(corners, np.asarray(point, dtype=float))
    positions = np.einsum("ij,ijk->ik", weights, corners)
    distances = np.linalg.norm(positions - point, axis=1)
    best = int(np.argmin(distances))
    return NearestPoint(positions[best], float(distances[best]), int(near[best]), weights[best])


def nearest_vertices(mesh: HeadMesh, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return how far the nearest vertex is from each point, (n,) float, mm, and its index."""
    indices = np.empty(len(points), dtype=int)
    squares = np.einsum("ij,ij->i", mesh.vertices, mesh.vertices)
    columns, doubled = np.ascontiguousarray(mesh.vertices.T), -2.0 * points
    compared = np.empty((POINTS_AT_ONCE, len(squares)))
    for start in range(0, len(points), POINTS_AT_ONCE):
        rows = doubled[start : start + POINTS_AT_ONCE]
        # |v|² − 2 v·p: as |v − p|², without what all vertices share.
        some = np.matmul(rows, columns, out=compared[: len(rows)])
        some += squares
        indices[start : start + len(rows)] = some.argmin(axis=1)
    return np.linalg.norm(mesh.vertices[indices] - points, axis=1), indices


def outward_normal(mesh: HeadMesh, point: np.ndarray) -> np.ndarray:
    """Return the outward unit normal (3,) of the surface where it is nearest to `point`."""
    return normal_at(mesh, nearest_on_mesh(mesh, point))


def normal_at(mesh: HeadMesh, nearest: NearestPoint) -> np.ndarray:
    """Return the outward unit normal (3,) at a place of the surface."""
    normal = nearest.weights @ mesh.vertex_normals[mesh.triangles[nearest.triangle]]
    return normal / np.linalg.norm(normal)


def outward_normals(mesh: HeadMesh, points: np.ndarray) -> np.ndarray:
    """Return the outward unit normals (n, 3) where the surface is nearest to `points` (n, 3)."""
    return np.array([outward_normal(mesh, point) for point in points])


def hides(mesh: HeadMesh, eye: np.ndarray, point: np.ndarray, slack_mm: float = 1.0) -> bool:
    """Return whether the surface is between `eye` and `point`, both (3,).

    The last `slack_mm` are ignored, because the point is on the surface. (Ray and triangle by
    Möller and Trumbore 1997.)
    """
    start = np.asarray(eye, dtype=float)
    along = point - start
    a, b, c = (mesh.vertices[mesh.triangles[:, corner]] for corner in range(3))
    across = np.cross(along, c - a)
    determinant = np.einsum("ij,ij->i", b - a, across)
    safe = np.where(np.abs(determinant) > 1e-12, determinant, np.inf)
    from_a = start - a
    u = np.einsum("ij,ij->i", from_a, across) / safe
    turned = np.cross(from_a, b - a)
    v = turned @ along / safe
    share = np.einsum("ij,ij->i", c - a, turned) / safe
    last = 1.0 - slack_mm / np.linalg.norm(along)
    return bool(np.any((u >= 0) & (v >= 0) & (u + v <= 1) & (share > 0) & (share < last)))


def _nearest_weights(corners: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Return the barycentric weights (m, 3) of the nearest point of each triangle (m, 3, 3)."""
    weights = _weights_in_plane(corners, point)
    outside = np.flatnonzero(np.any(weights < 0, axis=1))
    weights[outside] = _weights_on_sides(corners[outside], point)
    return weights


def _weights_in_plane(corners: np.ndarray, point: np.ndarray) -> np.ndarray:
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    area = np.einsum("ij,ij->i", normal, normal)
    # A triangle without area has no inside: its nearest point lies on a side.
    area = np.where(area > 0, area, -np.inf)
    of_b = np.einsum("ij,ij->i", np.cross(point - a, c - a), normal) / area
    of_c = np.einsum("ij,ij->i", np.cross(b - a, point - a), normal) / area
    weights = np.stack([1.0 - of_b - of_c, of_b, of_c], axis=1)
    weights[~np.isfinite(area)] = -1.0
    return weights


def _weights_on_sides(corners: np.ndarray, point: np.ndarray) -> np.ndarray:
    rows = np.arange(len(corners))
    best, best_distance = np.zeros((len(corners), 3)), np.full(len(corners), np.inf)
    for first, second in ((0, 1), (1, 2), (2, 0)):
        start, along = corners[:, first], corners[:, second] - corners[:, first]
        squared = np.maximum(np.einsum("ij,ij->i", along, along), 1e-30)
        share = np.clip(np.einsum("ij,ij->i", point - start, along) / squared, 0.0, 1.0)
        distance = np.linalg.norm(start + share[:, None] * along - point, axis=1)
        better = distance < best_distance
        best_distance = np.where(better, distance, best_distance)
        best[better] = 0.0
        best[rows[better], first] = 1.0 - share[better]
        best[rows[better], second] = share[better]
    return best
