"""Where several starts of a fit put the points on a surface, and the next step of each.

The steps are those of Gauss and Newton, and near the end of Newton.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from rastrainer.head.mesh import HeadMesh

STEP_MM = 10.0
"""No step moves a point of the trace farther: the nearest points are others there."""
_DAMPING = 1e-7
"""Of the curvature's trace: a direction that the points leave open is not followed far."""


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


@dataclass(frozen=True)
class WholeStep:
    """The whole steps of s starts.

    Attributes:
        shifts: (s, 3) float, mm, of the trace's center.
        turns: (s, 3) float, rad, about it.
        centers: (s, 3) float, RAS mm.
        slope: (s,) float, mm², by how much the cost changes along the step, to first order.
    """

    shifts: np.ndarray
    turns: np.ndarray
    centers: np.ndarray
    slope: np.ndarray

    def taken_by(
        self, share: np.ndarray, here: SurfaceFit, points: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return matrices, the points' places, and the longest move after a share (s,) of it."""
        turn = rotations(share[:, None] * self.turns)
        moved = np.zeros_like(here.matrices)
        moved[:, :3, :3] = turn @ here.matrices[:, :3, :3]
        from_center = here.matrices[:, :3, 3] - self.centers
        moved[:, :3, 3] = (turn @ from_center[..., None])[..., 0] + self.centers
        moved[:, :3, 3] += share[:, None] * self.shifts
        moved[:, 3, 3] = 1.0
        places = transforms_of(moved, points)
        moves = places - transforms_of(here.matrices, points)
        return moved, places, np.sqrt(np.einsum("sni,sni->sn", moves, moves).max(axis=1))


def whole_step(
    points: np.ndarray, mesh: HeadMesh, here: SurfaceFit, gate: np.ndarray, is_near: np.ndarray
) -> WholeStep:
    """Return the steps of Gauss and Newton; of starts (s,) bool near their ends, of Newton."""
    places = transforms_of(here.matrices, points)
    center = places.mean(axis=1)
    arms = places - center[:, None]
    # Rotations are counted in mm at the trace's own extent, so that all parameters are alike.
    extent = np.sqrt(np.mean(np.sum(arms**2, axis=2), axis=1))
    normals = plane_normals(mesh, here, points)
    rows = np.concatenate([normals, cross_products(arms, normals) / extent[:, None, None]], axis=2)
    weighted = rows * (here.distances_mm <= gate[:, None])[..., None]
    hessian = np.swapaxes(weighted, 1, 2) @ rows
    if is_near.any():
        gate = np.where(is_near, gate, -1.0)
        _add_bends(hessian, mesh, here, normals, arms, extent, gate)
    gradient = np.einsum("sni,sn->si", weighted, here.distances_mm)
    scale = np.trace(hessian, axis1=1, axis2=2) * _DAMPING + 1e-12
    step = -np.linalg.solve(hessian + scale[:, None, None] * np.eye(6), gradient[..., None])[..., 0]
    reach = np.linalg.norm(step[:, :3], axis=1) + np.linalg.norm(step[:, 3:], axis=1)
    step *= np.minimum(1.0, STEP_MM / np.maximum(reach, 1e-12))[:, None]
    slope = 2.0 * np.einsum("si,si->s", gradient, step)
    return WholeStep(step[:, :3], step[:, 3:] / extent[:, None], center, slope)


def _add_bends(
    hessian: np.ndarray,
    mesh: HeadMesh,
    here: SurfaceFit,
    normals: np.ndarray,
    arms: np.ndarray,
    extent: np.ndarray,
    gate: np.ndarray,
) -> None:
    """Add to the curvature (s, 6, 6) of points within gates (s,) what edges and corners add.

    The squared distance to a plane bends along its normal alone, that to an edge also across the
    edge, and that to a corner in all directions.
    """
    own = np.abs(np.einsum("sni,sni->sn", normals, mesh.triangle_normals[here.triangles]))
    which, point = np.nonzero((own < 1.0 - 1e-7) & (here.distances_mm <= gate[:, None]))
    if not len(which):
        return
    corners = mesh.vertices[mesh.triangles[here.triangles[which, point]]]
    along = np.roll(corners, -1, axis=1) - corners
    along /= np.maximum(np.linalg.norm(along, axis=2, keepdims=True), 1e-12)
    off = here.nearest_mm[which, point][:, None] - corners
    is_on = np.linalg.norm(np.cross(off, along), axis=2) < 1e-6
    normal = normals[which, point]
    edge = along[np.arange(len(which)), is_on.argmax(axis=1)]
    across = np.cross(edge, normal)
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12)
    across *= is_on.any(axis=1)[:, None]
    is_corner = is_on.sum(axis=1) > 1
    third = np.cross(normal, across) * is_corner[:, None]
    for direction in (across, third):
        turning = cross_products(arms[which, point], direction) / extent[which][:, None]
        rows = np.concatenate([direction, turning], axis=1)
        np.add.at(hessian, which, rows[:, :, None] * rows[:, None, :])
