"""The fiducial localization error (FLE) that explains the residuals of a registration.

It is isotropic by default. The skin stops the tip, so the error across the skin may differ from the
error along it; with known surface normals both are estimated from the residuals. This
matters: for fiducials on one side of a head, the errors across the skin determine its tilt.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.registration.fits import PARAMETERS, motions
from rastrainer.registration.registration import Registration


@dataclass(frozen=True)
class LocalizationError:
    """How the fiducials of a registration are localized: independently, with mean zero.

    The covariances of their errors, (n, 3, 3) float, mm², are in the fixed space. The degrees of
    freedom, which need not be a whole number, say how well their common size is known.
    """

    covariances: np.ndarray
    degrees_of_freedom: float

    @property
    def fle_mm(self) -> float:
        """RMS length of the error of one fiducial, mm."""
        return math.sqrt(np.trace(self.covariances, axis1=1, axis2=2).mean())


def degrees_of_freedom(registration: Registration) -> int:
    """Return the residual degrees of freedom: 3N minus the parameters of the fit."""
    count = len(registration.labels)
    dof = 3 * count - PARAMETERS[registration.kind]
    if dof < 1:
        raise InputError(
            f"Any {count} pairs of points fit a registration of type {registration.kind} exactly, "
            "so its residuals say nothing about the target error; add a point."
        )
    return dof


def isotropic_error(registration: Registration) -> LocalizationError:
    """Return the error that is the same in all directions and explains the FRE.

    From E[FRE²] = (1 − p/3N) E[FLE²] with p parameters: 1 − 2/N rigid (Sibson 1979),
    1 − 7/(3N) similarity, 1 − 4/N affine. A weighted fit takes the variance of each point as
    inverse to its weight, s²/wᵢ per coordinate, with E[Σ wᵢ|rᵢ|²] = (3N − p)·s².
    """
    dof = degrees_of_freedom(registration)
    count = len(registration.labels)
    weights = registration.weights
    if weights is None:
        variances = np.full(count, count * registration.fre_mm**2 / dof)
    else:
        variances = (weights @ registration.residuals_mm**2) / dof / weights
    return LocalizationError(variances[:, None, None] * np.eye(3), dof)


def stated_error(fle_mm: np.ndarray) -> LocalizationError:
    """Return the error of points whose localization errors are known, and equal in all directions.

    `fle_mm` is the RMS length of each, (n,): √3 times the standard deviation on each axis.
    """
    variances = np.asarray(fle_mm, dtype=float) ** 2 / 3.0
    return LocalizationError(variances[:, None, None] * np.eye(3), math.inf)


def expected_fre(registration: Registration, localization: LocalizationError) -> float:
    """Return √E[FRE²], mm: the root mean square of the residuals that such errors leave.

    With L what the fit leaves of the errors, E[FRE²] = tr(L Σ Lᵀ)/N; (1 − 2/N) E[FLE²] of a rigid
    fit without weights.
    """
    left = _left_by_fit(registration)
    covariance = left @ _block_diagonal(localization.covariances) @ left.T
    return math.sqrt(np.trace(covariance) / len(registration.labels))


def misfit_probability(registration: Registration, fle_mm: np.ndarray) -> float:
    """Return the probability of residuals this large or larger where the stated errors are true.

    Σ 3|rᵢ|²/FLEᵢ² of a fit weighted by 1/FLE² is χ² with 3N − p degrees of freedom. `fle_mm` is as
    stated, (n,).
    """
    from scipy import special

    value = float(np.sum(3.0 * registration.residuals_mm**2 / np.asarray(fle_mm) ** 2))
    return float(special.chdtrc(degrees_of_freedom(registration), value))


def error_along_surface(registration: Registration, normals: np.ndarray) -> LocalizationError:
    """Return the error whose parts along and across a surface explain the residuals.

    With M what the fit leaves of the errors, B the projection of each error onto its part, and e
    the residuals, E[eᵀBe] = Σ σ² tr(M B M B') over both parts: two equations for two variances
    (method of moments; a negative one counts as zero). The degrees of freedom belong to the χ² with
    the mean and variance of eᵀe (Satterthwaite 1946). It is for fits without weights.

    `normals` are the surface's unit normals (n, 3) at the fixed points.
    """
    count = len(registration.labels)
    degrees_of_freedom(registration)
    normals = np.asarray(normals, dtype=float)
    if normals.shape != (count, 3) or not np.allclose(np.linalg.norm(normals, axis=1), 1.0):
        raise InputError(f"There must be {count} normals of length 1, one for each fiducial.")
    residuals = registration.residual_vectors_mm.ravel()
    if not residuals.any():
        return isotropic_error(registration)
    across = normals[:, :, None] * normals[:, None, :]
    parts = (across, np.eye(3) - across)
    left = _left_by_fit(registration)
    seen = [left @ _block_diagonal(part) for part in parts]
    equations = [[np.sum(one * other.T) for other in seen] for one in seen]
    sizes = [residuals @ _block_diagonal(part) @ residuals for part in parts]
    variances = np.clip(np.linalg.solve(equations, sizes), 0.0, None)
    both = variances[0] * seen[0] + variances[1] * seen[1]
    scale = residuals @ residuals / np.trace(both)
    covariances = scale * (variances[0] * parts[0] + variances[1] * parts[1])
    return LocalizationError(covariances, np.trace(both) ** 2 / np.sum(both * both.T))


def fit_of_errors(registration: Registration) -> np.ndarray:
    """Return what the errors of the fiducials do to the fit, (parameters, n, 3) float.

    A weighted fit has (Σ wᵢ JᵢᵀJᵢ)⁻¹ wᵢJᵢᵀ with Jᵢ the motions of point i.
    """
    _, fit = _normal_equations(registration)
    return fit.reshape(len(fit), -1, 3)


def _left_by_fit(registration: Registration) -> np.ndarray:
    """Return the (3n, 3n) projection of the fiducials' errors onto their residuals."""
    moved, fit = _normal_equations(registration)
    return np.eye(len(moved)) - moved @ fit


def _normal_equations(registration: Registration) -> tuple[np.ndarray, np.ndarray]:
    """Return how the fiducials move with the parameters, and the parameters with their errors.

    The arrays are (3n, parameters) and (parameters, 3n).
    """
    fixed = registration.fixed_mm
    moved = motions(registration.kind, fixed - fixed.mean(axis=0)).reshape(3 * len(fixed), -1)
    if registration.weights is None:
        return moved, np.linalg.pinv(moved)
    roots = np.repeat(np.sqrt(registration.weights / registration.weights.max()), 3)
    return moved, np.linalg.pinv(roots[:, None] * moved) * roots


def _block_diagonal(blocks: np.ndarray) -> np.ndarray:
    count = len(blocks)
    whole = np.zeros((count, 3, count, 3))
    whole[np.arange(count), :, np.arange(count), :] = blocks
    return whole.reshape(3 * count, 3 * count)
