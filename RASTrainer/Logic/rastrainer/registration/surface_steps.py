"""The steps of a fit to a surface: those of Gauss and Newton, and near the end of Newton."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.head.mesh import HeadMesh
from rastrainer.registration.surface_placement import (
    SurfaceFit,
    cross_products,
    plane_normals,
    rotations,
    transforms_of,
)

STEP_MM = 10.0
"""No step moves a point of the trace farther: the nearest points are others there."""
_DAMPING = 1e-7
"""Of the curvature's trace: a direction that the points leave open is not followed far."""


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
