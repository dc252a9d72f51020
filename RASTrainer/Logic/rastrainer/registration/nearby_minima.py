"""The lowest of the minima next to a fit, since a head made of triangles has many close together.

Where another triangle becomes the nearest of some point, the cost has a kink, and on each side of
it there may be a minimum; they lie some hundredths of a millimeter apart, and their costs differ by
thousandths of a percent. So the fit is repeated from many places about as far off as the pose is
uncertain, and the lowest is taken.
"""

from __future__ import annotations

import numpy as np
from numpy.random import default_rng

from rastrainer.head.mesh import HeadMesh
from rastrainer.registration.surface_fit import costs, fit_to_surface
from rastrainer.registration.surface_placement import (
    SurfaceFit,
    plane_normals,
    rotations,
    transforms_of,
)

NEARBY = 24
"""Starts; of the heads that were compared, the lowest minimum draws one in ten or more."""
NEARBY_SD = 0.25, 1.0
"""How far off every other is, in standard deviations of the pose, estimated from the residuals."""
NEARBY_MM = 2.0
"""How far off at most, along each axis of the pose."""
NEARBY_STEPS, FOLLOWED = 2, 8
"""After so many steps, so many of the starts are followed to their ends."""


def lowest_nearby(
    points: np.ndarray,
    mesh: HeadMesh,
    fit: SurfaceFit,
    tolerance_mm: float,
    gate_mm: float,
    seed: int,
) -> SurfaceFit:
    """Return the lowest minimum found next to a fit of one start, as a fit of one start.

    Args:
        points: (n, 3) float, World mm, those of the fit.
        mesh: The surface, RAS mm.
        fit: The fit.
        tolerance_mm: As of `fit_to_surface`.
        gate_mm: Up to which distance points count.
        seed: Of the places from which the fit is repeated.
    """
    begun = np.concatenate([fit.matrices, _moved(points, mesh, fit, gate_mm, seed)])
    first = fit_to_surface(
        points,
        mesh,
        begun,
        tolerance_mm,
        gate_mm=gate_mm,
        max_iterations=NEARBY_STEPS,
        around=fit.matrices[0],
    )
    order = costs(first.distances_mm, gate_mm).argsort(kind="stable")[:FOLLOWED]
    begun = first.matrices[order]
    ended = fit_to_surface(points, mesh, begun, tolerance_mm, gate_mm=gate_mm, around=begun[0])
    lowest = costs(ended.distances_mm, gate_mm).argmin()
    return ended.taken(np.array([lowest]))


def _moved(
    points: np.ndarray, mesh: HeadMesh, fit: SurfaceFit, gate_mm: float, seed: int
) -> np.ndarray:
    """Return matrices (NEARBY, 4, 4) about that of a fit, by the covariance of its pose."""
    counts = fit.distances_mm[0] <= gate_mm
    places = transforms_of(fit.matrices, points)[0]
    center = places.mean(axis=0)
    extent = float(np.sqrt(np.mean(np.sum((places - center) ** 2, axis=1))))
    normals = plane_normals(mesh, fit, points)[0][counts]
    rows = np.concatenate([normals, np.cross(places[counts] - center, normals) / extent], axis=1)
    curvature, axes = np.linalg.eigh(rows.T @ rows)
    variance = np.mean(fit.distances_mm[0][counts] ** 2) / np.maximum(curvature, 1e-9)
    sizes = np.minimum(np.resize(NEARBY_SD, (NEARBY, 1)) * np.sqrt(variance), NEARBY_MM)
    steps = (default_rng([seed, 1]).normal(size=(NEARBY, 6)) * sizes) @ axes.T
    moved = np.tile(np.eye(4), (NEARBY, 1, 1))
    moved[:, :3, :3] = rotations(steps[:, 3:] / extent)
    moved[:, :3, 3] = center - moved[:, :3, :3] @ center + steps[:, :3]
    return np.asarray(moved @ fit.matrices[0])
