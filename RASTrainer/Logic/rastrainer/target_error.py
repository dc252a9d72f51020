"""What error to expect at a target: TRE from the residuals of a registration.

The fiducial localization error (FLE) is taken as independent and normal. FRE tells the size of FLE
over the whole set; it does not predict the TRE of a single case (Fitzpatrick 2009), which is why an
interval goes with every expectation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rastrainer.distributions import ratio_quantile
from rastrainer.errors import InputError
from rastrainer.localization_error import (
    LocalizationError,
    fit_of_errors,
    isotropic_error,
    motions,
)
from rastrainer.registration import Registration

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


def expected_tre(
    registration: Registration,
    targets: np.ndarray,
    localization: LocalizationError | None = None,
) -> np.ndarray:
    """Return √E[TRE²] at targets of the fixed space, (m,) float, in mm.

    For a rigid registration with isotropic FLE this is Fitzpatrick's equation 46 (1998),
    E[TRE²] = E[FLE²]/N · (1 + ⅓ Σₖ dₖ²/fₖ²).

    Args:
        registration: The registration whose errors are asked for.
        targets: (m, 3) float, in mm.
        localization: The FLE; by default the isotropic one that explains the residuals.

    Raises:
        InputError: the fit leaves no residuals, or a target is not finite.
    """
    localization = localization or isotropic_error(registration)
    covariances = _propagated(registration, targets, localization.covariances)
    return np.sqrt(np.trace(covariances, axis1=1, axis2=2))


def target_error(
    registration: Registration,
    target: np.ndarray,
    localization: LocalizationError | None = None,
    confidence: float = CONFIDENCE,
) -> TargetError:
    """Return the error to expect at a target, with the interval that holds it.

    The interval accounts for the direction dependence of the error and for the uncertainty of the
    estimated FLE; it is wide for few points. An FRE of zero gives zero and an interval of zero.

    Args:
        registration: The registration whose error is asked for.
        target: (3,) float, in the fixed space, in mm.
        localization: The FLE; by default the isotropic one that explains the residuals.
        confidence: Probability that the error lies in the interval; outside it, both sides are
            equally likely.

    Raises:
        InputError: the fit leaves no residuals, or the target is not finite.
    """
    localization = localization or isotropic_error(registration)
    targets = np.reshape(target, (1, -1))
    covariance = _propagated(registration, targets, localization.covariances)[0]
    expected = math.sqrt(np.trace(covariance))
    low, high = (0.0, 0.0)
    if expected > 0.0:
        tail = (1 - confidence) / 2
        weights = np.linalg.eigvalsh(covariance).clip(min=0.0)
        dof = localization.degrees_of_freedom
        low, high = (math.sqrt(ratio_quantile(p, weights, dof)) for p in (tail, 1 - tail))
    return TargetError(
        target_mm=tuple(float(value) for value in target),
        fle_mm=localization.fle_mm,
        expected_mm=expected,
        interval_mm=(low, high),
        confidence=confidence,
    )


def tre_covariances(registration: Registration, targets: np.ndarray) -> np.ndarray:
    """Return the covariance of TRE at each target for an isotropic FLE of variance 1 a coordinate.

    Args:
        registration: Its fixed points and kind are used.
        targets: (m, 3) float, in the fixed space, in mm.

    Returns:
        (m, 3, 3) float, in mm² for each mm² of variance.

    Raises:
        InputError: a target is not three finite numbers.
    """
    unit = np.tile(np.eye(3), (len(registration.labels), 1, 1))
    return _propagated(registration, targets, unit)


def _propagated(
    registration: Registration, targets: np.ndarray, covariances: np.ndarray
) -> np.ndarray:
    """Return the covariance (m, 3, 3) of TRE that FLE of covariances (n, 3, 3) causes.

    To first order: the errors change the fit's parameters, and these move the target.
    """
    fit = fit_of_errors(registration)
    of_parameters = np.einsum("pni,nij,qnj->pq", fit, covariances, fit)
    center = registration.fixed_mm.mean(axis=0)
    moved = motions(registration.kind, _checked_targets(targets) - center)
    return moved @ of_parameters @ np.swapaxes(moved, 1, 2)


def _checked_targets(targets: np.ndarray) -> np.ndarray:
    array = np.asarray(targets, dtype=float)
    if array.ndim != 2 or array.shape[1] != 3 or not np.isfinite(array).all():
        raise InputError("Each target must be three finite coordinates (x, y, z in mm).")
    return array
