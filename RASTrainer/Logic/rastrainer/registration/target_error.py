"""The expected error at a target: TRE from the residuals of a registration.

The fiducial localization error (FLE) is assumed to be independent, unbiased and normal. FRE
reflects the size of FLE over the whole set; it does not predict the TRE of a single case
(Fitzpatrick 2009), so each expectation has an interval.

An offset common to all touches, for example of a wrongly calibrated tip, adds fully to the TRE and
changes no residual. No registration can detect it, so its standard deviation on each axis is an
assumption, `COMMON_BIAS_SD_MM`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.registration.distributions import (
    ratio_quantile,
    widened_probability,
    widened_quantile,
)
from rastrainer.registration.fits import motions
from rastrainer.registration.localization_error import (
    LocalizationError,
    fit_of_errors,
    isotropic_error,
)
from rastrainer.registration.registration import Registration

CONFIDENCE = 0.95
COMMON_BIAS_SD_MM = 0.25
"""Of an offset that all touches share, on each axis; 0.43 mm RMS in space. Our own assumption, not
measured: pivoting located the tip of an optically tracked tool with a mean precision of 0.25 mm
(Yaniv 2015, "Which pivot calibration?", SPIE Medical Imaging). Aiming beside every point, or
hovering above it, is a larger one."""
INTERVAL_NOTE = (
    "The 95 % interval of the expected TRE holds only where the errors of the points are "
    "independent, unbiased and alike. Of an offset that all touches share it allows for a standard "
    f"deviation of {COMMON_BIAS_SD_MM:g} mm on each axis; a larger one it cannot see."
)


@dataclass(frozen=True)
class TargetError:
    """The error to expect at one target.

    Attributes:
        target_mm: The target in the fixed space.
        fle_mm: RMS length of the localization error of one fiducial.
        expected_mm: RMS length of the error at the target, √E[TRE²]: the part below and the
            common offset, added in squares.
        independent_mm: The part of it that the errors of single points cause.
        interval_mm: Where the length of the error lies with at least the given confidence, both
            ends in mm, whatever the standard deviation of the common offset is, up to the assumed
            one.
        confidence: Least probability of the interval.
        common_bias_sd_mm: The assumed standard deviation of the common offset on each axis.
    """

    target_mm: tuple[float, float, float]
    fle_mm: float
    expected_mm: float
    independent_mm: float
    interval_mm: tuple[float, float]
    confidence: float
    common_bias_sd_mm: float


def expected_tre(
    registration: Registration,
    targets: np.ndarray,
    localization: LocalizationError | None = None,
    common_bias_sd_mm: float = COMMON_BIAS_SD_MM,
) -> np.ndarray:
    """Return √E[TRE²] at targets of the fixed space, (m,) float, in mm.

    For a rigid registration with isotropic FLE, alike at all points, and without a common offset
    this is Fitzpatrick's equation 46 (1998), E[TRE²] = E[FLE²]/N · (1 + ⅓ Σₖ dₖ²/fₖ²). An offset of
    standard deviation σ on each axis adds 3σ².

    Args:
        registration: The registration.
        targets: (m, 3) float, in mm.
        localization: The FLE; by default the isotropic one that explains the residuals.
        common_bias_sd_mm: σ.

    Raises:
        InputError: the fit leaves no residuals, or a target is not finite.
    """
    localization = localization or isotropic_error(registration)
    covariances = _propagated(registration, targets, localization.covariances)
    return np.sqrt(np.trace(covariances, axis1=1, axis2=2) + 3.0 * common_bias_sd_mm**2)


def target_error(
    registration: Registration,
    target: np.ndarray,
    localization: LocalizationError | None = None,
    confidence: float = CONFIDENCE,
    common_bias_sd_mm: float = COMMON_BIAS_SD_MM,
) -> TargetError:
    """Return the error to expect at a target, with an interval for it.

    The interval accounts for the direction dependence of the error and for the uncertainty of the
    estimated FLE; it is wide for few points. TRE grows with the common offset, so the lower end is
    that of the distribution without an offset. The upper end is where, with the assumed offset, the
    error lies between both with the given confidence. With a smaller one it does so more often: the
    probability between two ends has a single maximum over the size of the error. An FRE of zero
    leaves the common offset alone.

    Args:
        registration: The registration.
        target: (3,) float, in the fixed space, in mm.
        localization: The FLE; by default the isotropic one that explains the residuals.
        confidence: Least probability that the error lies in the interval.
        common_bias_sd_mm: Standard deviation on each axis of an offset that all points share; 0
            for none, and both sides outside of the interval are equally likely then.

    Raises:
        InputError: the fit leaves no residuals, or the target is not finite.
    """
    localization = localization or isotropic_error(registration)
    targets = np.reshape(target, (1, -1))
    covariance = _propagated(registration, targets, localization.covariances)[0]
    return error_of_covariance(
        targets[0],
        covariance,
        fle_mm=localization.fle_mm,
        degrees_of_freedom=localization.degrees_of_freedom,
        confidence=confidence,
        common_bias_sd_mm=common_bias_sd_mm,
    )


def error_of_covariance(
    target: np.ndarray,
    covariance: np.ndarray,
    *,
    fle_mm: float,
    degrees_of_freedom: float,
    confidence: float = CONFIDENCE,
    common_bias_sd_mm: float = COMMON_BIAS_SD_MM,
) -> TargetError:
    """Return the error at a target whose independent part has a covariance, as `target_error`.

    Args:
        target: (3,) float, in the fixed space, in mm.
        covariance: (3, 3) float, mm², without the common offset.
        fle_mm: The error of a point that it was computed from.
        degrees_of_freedom: How well its size is known.
        confidence: As of `target_error`.
        common_bias_sd_mm: As of `target_error`.
    """
    variances = np.linalg.eigvalsh(covariance).clip(min=0.0)
    independent = float(variances.sum())
    added, dof = common_bias_sd_mm**2, degrees_of_freedom
    lowest = _quantile((1 - confidence) / 2, variances, dof, 0.0)
    x, y, z = (float(value) for value in target)
    return TargetError(
        target_mm=(x, y, z),
        fle_mm=fle_mm,
        expected_mm=math.sqrt(independent + 3.0 * added),
        independent_mm=math.sqrt(independent),
        interval_mm=(
            math.sqrt(lowest),
            math.sqrt(_highest(lowest, confidence, variances, dof, added)),
        ),
        confidence=confidence,
        common_bias_sd_mm=common_bias_sd_mm,
    )


def true_errors(
    world_to_head: np.ndarray, head_to_world: np.ndarray, points: np.ndarray
) -> np.ndarray:
    """Return how far a registration puts points from where they are, (..., 3) float, mm.

    Args:
        world_to_head: (4, 4) float, mm, the registration.
        head_to_world: (4, 4) float, mm, where the head really is.
        points: (..., 3) float, RAS mm.
    """
    return transforms.apply(world_to_head @ head_to_world, points) - points


def _quantile(probability: float, variances: np.ndarray, dof: float, added: float) -> float:
    """Return the quantile of TRE², mm², for variances along its principal axes."""
    if added == 0.0 and not variances.any():
        return 0.0
    if added == 0.0 and math.isfinite(dof):
        return ratio_quantile(probability, variances, dof)
    return widened_quantile(probability, variances, dof, added)


def _highest(
    lowest: float, confidence: float, variances: np.ndarray, dof: float, added: float
) -> float:
    """Return up to which TRE², mm², from the lowest one, there is so much confidence."""
    if added == 0.0:
        return _quantile((1 + confidence) / 2, variances, dof, 0.0)
    below = widened_probability(lowest, variances, dof, added)
    return _quantile(below + confidence, variances, dof, added)


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
