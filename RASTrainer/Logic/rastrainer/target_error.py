"""What error to expect at a target: TRE from the residuals of a registration.

The fiducial localization error (FLE) is taken as independent, isotropic and normal. FRE tells the
size of FLE over the whole set; it does not predict the TRE of a single case (Fitzpatrick 2009),
which is why an interval goes with every expectation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rastrainer.distributions import ratio_quantile
from rastrainer.errors import InputError
from rastrainer.registration import AFFINE, SIMILARITY, Registration
from rastrainer.registration_fits import PARAMETERS

CONFIDENCE = 0.95


@dataclass(frozen=True)
class TargetError:
    """The error to expect at one target.

    Attributes:
        target_mm: The target in the fixed space.
        fle_mm: Estimated RMS length of the localization error of one fiducial.
        expected_mm: RMS length of the error at the target, √E[TRE²].
        interval_mm: Where the length of the error lies with the given confidence, both ends in mm.
        confidence: Probability of the interval.
    """

    target_mm: tuple[float, float, float]
    fle_mm: float
    expected_mm: float
    interval_mm: tuple[float, float]
    confidence: float


def degrees_of_freedom(registration: Registration) -> int:
    """Return how many residual coordinates are left after the fit: 3N minus its parameters.

    Raises:
        InputError: none is left, so that the residuals tell nothing.
    """
    count = len(registration.labels)
    dof = 3 * count - PARAMETERS[registration.kind]
    if dof < 1:
        raise InputError(
            f"Any {count} pairs of points fit a registration of type {registration.kind} exactly, "
            "so its residuals tell nothing about the target error; add a point."
        )
    return dof


def estimated_fle(registration: Registration) -> float:
    """Return the RMS length of the localization error that explains the FRE, in mm.

    From E[FRE²] = (1 − p/3N) E[FLE²] with p parameters: 1 − 2/N rigid (Sibson 1979),
    1 − 7/(3N) similarity, 1 − 4/N affine.

    Raises:
        InputError: the fit leaves no residuals to estimate from.
    """
    share = degrees_of_freedom(registration) / (3 * len(registration.labels))
    return registration.fre_mm / math.sqrt(share)


def expected_tre(registration: Registration, targets: np.ndarray) -> np.ndarray:
    """Return √E[TRE²] at targets of the fixed space, (m,) float, in mm.

    For a rigid registration this is Fitzpatrick's equation 46 (1998),
    E[TRE²] = E[FLE²]/N · (1 + ⅓ Σₖ dₖ²/fₖ²).

    Args:
        registration: The registration whose errors are asked for.
        targets: (m, 3) float, in mm.

    Raises:
        InputError: the fit leaves no residuals, or a target is not finite.
    """
    covariances = tre_covariances(registration, targets)
    variance = estimated_fle(registration) ** 2 / 3
    return np.sqrt(variance * np.trace(covariances, axis1=1, axis2=2))


def target_error(
    registration: Registration, target: np.ndarray, confidence: float = CONFIDENCE
) -> TargetError:
    """Return the error to expect at a target, with the interval that holds it.

    The interval accounts for the direction dependence of the error and for the uncertainty of the
    estimated FLE; it is wide for few points. An FRE of zero gives zero and an interval of zero.

    Args:
        registration: The registration whose error is asked for.
        target: (3,) float, in the fixed space, in mm.
        confidence: Probability that the error lies in the interval; outside it, both sides are
            equally likely.

    Raises:
        InputError: the fit leaves no residuals, or the target is not finite.
    """
    covariance = tre_covariances(registration, np.reshape(target, (1, -1)))[0]
    weights = np.linalg.eigvalsh(covariance)
    dof = degrees_of_freedom(registration)
    fle = estimated_fle(registration)
    deviation = fle / math.sqrt(3)
    tail = (1 - confidence) / 2
    low, high = (
        deviation * math.sqrt(ratio_quantile(probability, weights, dof))
        for probability in (tail, 1 - tail)
    )
    return TargetError(
        target_mm=tuple(float(value) for value in target),
        fle_mm=fle,
        expected_mm=deviation * math.sqrt(np.trace(covariance)),
        interval_mm=(low, high),
        confidence=confidence,
    )


def tre_covariances(registration: Registration, targets: np.ndarray) -> np.ndarray:
    """Return the covariance of TRE at each target for an FLE of variance 1 a coordinate.

    To first order, with r the target and p the fiducials about their centroid: the translation
    gives I/N, the rotation [r]ₓ J⁻¹ [r]ₓᵀ with J the inertia of the fiducials, the scale of a
    similarity r rᵀ/Σ|p|²; an affine fit gives (1/N + rᵀ(Σ p pᵀ)⁻¹ r) I.

    Args:
        registration: Its fixed points and kind are used.
        targets: (m, 3) float, in the fixed space, in mm.

    Returns:
        (m, 3, 3) float, in mm² for each mm² of variance.

    Raises:
        InputError: a target is not three finite numbers.
    """
    r = _checked_targets(targets) - registration.fixed_mm.mean(axis=0)
    p = registration.fixed_mm - registration.fixed_mm.mean(axis=0)
    scatter = p.T @ p
    total = np.trace(scatter)
    identity = np.eye(3)
    translation = identity / len(p)
    if registration.kind == AFFINE:
        spread = np.einsum("mi,ij,mj->m", r, np.linalg.inv(scatter), r)
        return translation + spread[:, None, None] * identity
    cross = np.cross(r[:, None, :], identity)
    inertia = total * identity - scatter
    covariances = translation + np.swapaxes(cross, 1, 2) @ np.linalg.inv(inertia) @ cross
    if registration.kind == SIMILARITY:
        covariances = covariances + r[:, :, None] * r[:, None, :] / total
    return covariances


def _checked_targets(targets: np.ndarray) -> np.ndarray:
    array = np.asarray(targets, dtype=float)
    if array.ndim != 2 or array.shape[1] != 3 or not np.isfinite(array).all():
        raise InputError("Each target must be three finite coordinates (x, y, z in mm).")
    return array
