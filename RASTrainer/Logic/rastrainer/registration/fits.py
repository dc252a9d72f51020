"""Point-based registration: rigid, similarity and affine fits of paired points.

All points are (n, 3) float in mm; every fit maps `moving` to `fixed` and minimizes the squared
distances in the fixed space (the similarity's scale is an exception, described there). A rigid fit
may weight the points, and minimizes Σ wᵢ|T(mᵢ) − fᵢ|² then (Horn 1987). The inputs are assumed to
be valid: `rastrainer.registration.registration` checks them.
"""

from __future__ import annotations

import numpy as np

from rastrainer import transforms

RIGID = "rigid"
SIMILARITY = "similarity"
AFFINE = "affine"
KINDS = (RIGID, SIMILARITY, AFFINE)
MINIMUM_POINTS = {RIGID: 3, SIMILARITY: 3, AFFINE: 4}
PARAMETERS = {RIGID: 6, SIMILARITY: 7, AFFINE: 12}


def fit(
    moving: np.ndarray, fixed: np.ndarray, kind: str, weights: np.ndarray | None = None
) -> np.ndarray:
    """Return the (4, 4) float transform of the given kind from moving to fixed.

    `weights` (n,) float, above 0, are for rigid fits; without them all points count equally.
    """
    if kind == AFFINE:
        solution, *_ = np.linalg.lstsq(_centered(moving), _centered(fixed), rcond=None)
        linear = solution.T
        return transforms.rigid(linear, fixed.mean(axis=0) - linear @ moving.mean(axis=0))
    scale = symmetric_scale(moving, fixed) if kind == SIMILARITY else 1.0
    linear = scale * _rotation(moving, fixed, weights)
    return transforms.rigid(linear, _center(fixed, weights) - linear @ _center(moving, weights))


def symmetric_scale(moving: np.ndarray, fixed: np.ndarray) -> float:
    """Return √(Σ|b|² / Σ|a|²), a and b the moving and fixed points about their centroids.

    It treats both sets equally (Horn 1987), as VTK's and ITK's landmark transforms do. Umeyama's
    least-squares scale is a little smaller; the two differ in the fourth digit on good data.
    """
    return float(np.linalg.norm(_centered(fixed)) / np.linalg.norm(_centered(moving)))


def motions(kind: str, points: np.ndarray) -> np.ndarray:
    """Return how points move with the parameters of a fit of a kind, (n, 3, parameters) float.

    `points` (n, 3) float are taken from the fiducials' centroid, mm. The parameters are, to first
    order, a translation, a rotation, and the scale of a similarity; an affine fit has a translation
    and nine coefficients.
    """
    translation = np.broadcast_to(np.eye(3), (len(points), 3, 3))
    if kind == AFFINE:
        linear = np.einsum("ij,nk->nijk", np.eye(3), points).reshape(-1, 3, 9)
        return np.concatenate([translation, linear], axis=2)
    rotation = np.swapaxes(np.cross(points[:, None, :], np.eye(3)), 1, 2)
    columns = [translation, -rotation]
    if kind == SIMILARITY:
        columns.append(points[:, :, None])
    return np.concatenate(columns, axis=2)


def rigid_sums_of_squares(
    moving: np.ndarray, fixed: np.ndarray, weights: np.ndarray, handedness: int = 1
) -> np.ndarray:
    """Return the residual Σ|T(m) − f|² of the best rigid fit, for many fits at once.

    It is Σ|a|² + Σ|b|² − 2(s₁ + s₂ + sign(det H)·s₃), with the singular values s₁ ≥ s₂ ≥ s₃ of the
    cross-covariance H; no transform need be built. The points are (..., n, 3) float, the weights
    (..., n) float, 1 for points that count, 0 for all others, and the squares (...) float, in mm².
    `handedness` is 1 for rotations, −1 for rotations with a reflection.
    """
    weights = weights[..., None]
    count = weights.sum(axis=-2, keepdims=True)
    a = moving - (weights * moving).sum(axis=-2, keepdims=True) / count
    b = fixed - (weights * fixed).sum(axis=-2, keepdims=True) / count
    covariance = np.swapaxes(weights * a, -1, -2) @ b
    singular = np.linalg.svd(covariance, compute_uv=False)
    sign = handedness * np.sign(np.linalg.det(covariance))
    gain = singular[..., 0] + singular[..., 1] + sign * singular[..., 2]
    total = (weights * (a**2 + b**2)).sum(axis=(-1, -2))
    return np.maximum(total - 2.0 * gain, 0.0)


def extents(points: np.ndarray) -> np.ndarray:
    """Return the RMS extents of the points along their principal axes, (3,) float, falling."""
    centered = points - points.mean(axis=0)
    return np.linalg.svd(centered, compute_uv=False) / np.sqrt(len(points))


def _rotation(moving: np.ndarray, fixed: np.ndarray, weights: np.ndarray | None) -> np.ndarray:
    """Return the (3, 3) rotation of Arun's SVD solution (1987) with Umeyama's guard (1991).

    Without the guard, noisy or mirrored points could yield a reflection.
    """
    a, b = moving - _center(moving, weights), fixed - _center(fixed, weights)
    u, _, vt = np.linalg.svd((b if weights is None else weights[:, None] * b).T @ a)
    guard = np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))])
    return u @ guard @ vt


def _center(points: np.ndarray, weights: np.ndarray | None) -> np.ndarray:
    return points.mean(axis=0) if weights is None else weights @ points / weights.sum()


def _centered(points: np.ndarray) -> np.ndarray:
    return points - points.mean(axis=0)
