"""Many simulated registrations of touches on the skin at once."""

from __future__ import annotations

import numpy as np

from rastrainer.registration.target_error import bias_of_errors
from rastrainer.trial.score_reference import Region


def errors_along_skin(
    normals: np.ndarray, fle_mm: float, sets: int, random: np.random.Generator
) -> np.ndarray:
    """Return independent errors of touches, (sets, n, 3) float, mm, of RMS length `fle_mm`.

    `normals` are the skin's, (n, 3) float.
    """
    errors = random.normal(0.0, fle_mm / np.sqrt(2.0), (sets, *normals.shape))
    return errors - normals * np.einsum("sij,ij->si", errors, normals)[..., None]


def registered_errors(region: Region, fixed_mm: np.ndarray, moving_mm: np.ndarray) -> np.ndarray:
    """Return the true errors over a region of many rigid fits (Arun 1987), (sets,) mm.

    The head is where its MRI is; `fixed_mm` is (n, 3) float, `moving_mm` (sets, n, 3).
    """
    centers, center = moving_mm.mean(axis=1), fixed_mm.mean(axis=0)
    u, _, vt = np.linalg.svd(
        np.einsum("sni,nj->sij", moving_mm - centers[:, None], fixed_mm - center)
    )
    vt[:, 2] *= np.sign(np.linalg.det(u @ vt))[:, None]
    turns = np.swapaxes(u @ vt, 1, 2)
    shifts = center - np.einsum("sij,sj->si", turns, centers)
    squares = [_mean_squares(turns, shifts, points) for points in (region.targets, region.grid)]
    # As `Region.mean`, which takes one registration at a time.
    return np.sqrt(np.mean(squares, axis=0))


def common_biases(normals: np.ndarray, errors_mm: np.ndarray) -> np.ndarray:
    """Return the lengths of the common biases of touches, (sets,) mm.

    `normals` are the skin's, (n, 3) float, `errors_mm` (sets, n, 3).
    """
    biases = np.einsum("inj,snj->si", bias_of_errors(normals), errors_mm)
    return np.linalg.norm(biases, axis=1)


def _mean_squares(turns: np.ndarray, shifts: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the mean |R p + t − p|² over points (n, 3), by their first and second moments."""
    mean, moment = points.mean(axis=0), points.T @ points / len(points)
    moved = turns - np.eye(3)
    return (
        np.einsum("sij,jk,sik->s", moved, moment, moved)
        + 2 * np.einsum("si,sij,j->s", shifts, moved, mean)
        + np.sum(shifts**2, axis=1)
    )
