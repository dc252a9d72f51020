"""The error of a registration at a target: expected from its residuals, or true; and common bias.

The fiducial localization error (FLE) is assumed to be independent, unbiased and normal. FRE
reflects the size of FLE over the whole set; it does not predict the TRE of a single case
(Fitzpatrick 2009), so each expectation has an interval.

An offset common to all touches, for example of a wrongly calibrated tip, adds fully to the TRE and
changes no residual. No registration can detect it, so its standard deviation on each axis is an
assumption, `COMMON_BIAS_SD_MM`.

Where the true pose is known, the bias along the skin that all touches share is estimated from their
true errors. Accuracy is precision and trueness (ISO 5725-1), and the error in the brain says little
about trueness: on a small patch of skin, such a bias is nearly a rotation about the center of the
head, which hardly moves the brain.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.registration import distributions, localization_error
from rastrainer.registration.fits import motions
from rastrainer.registration.registration import Registration

CONFIDENCE = 0.95
COMMON_BIAS_SD_MM = 0.25
"""Standard deviation on each axis of an offset that all touches share; 0.43 mm RMS in space. Our
own assumption, not measured: pivoting located the tip of an optically tracked tool with a mean
precision of 0.25 mm (Yaniv 2015, "Which pivot calibration?", SPIE Medical Imaging). Aiming off
every point, or hovering above it, is a larger offset."""
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
        interval_mm: Holds the length of the error with at least the given confidence, both ends in
            mm, for any common offset up to the assumed standard deviation.
        confidence: Least probability of the interval.
        common_bias_sd_mm: The assumed standard deviation of the common offset on each axis.
    """

    target_mm: tuple[float, float, float]
    fle_mm: float
    expected_mm: float
    independent_mm: float
    interval_mm: tuple[float, float]
    confidence: float = CONFIDENCE
    common_bias_sd_mm: float = COMMON_BIAS_SD_MM


def expected_tre(
    registration: Registration,
    targets: np.ndarray,
    localization: localization_error.LocalizationError | None = None,
    common_bias_sd_mm: float = COMMON_BIAS_SD_MM,
) -> np.ndarray:
    """Return √E[TRE²] at targets (m, 3) of the fixed space, (m,) float, in mm.

    For a rigid registration with isotropic FLE, alike at all points, and without a common offset
    this is Fitzpatrick's equation 46 (1998), E[TRE²] = E[FLE²]/N · (1 + ⅓ Σₖ dₖ²/fₖ²). An offset of
    standard deviation σ on each axis adds 3σ². The default FLE is isotropic and explains the
    residuals.
    """
    localization = localization or localization_error.isotropic_error(registration)
    covariances = _propagated(registration, targets, localization.covariances)
    return np.sqrt(np.trace(covariances, axis1=1, axis2=2) + 3.0 * common_bias_sd_mm**2)


def target_error(
    registration: Registration,
    target: np.ndarray,
    localization: localization_error.LocalizationError | None = None,
    common_bias_sd_mm: float = COMMON_BIAS_SD_MM,
) -> TargetError:
    """Return the error to expect at a target, with an interval for it.

    The interval accounts for the direction dependence of the error and for the uncertainty of the
    estimated FLE; it is wide for few points. TRE grows with the common offset, so the lower end
    comes from the distribution without an offset. The upper end is chosen so that, with the assumed
    offset, the error is between both ends with the given confidence. A smaller offset makes that
    more likely: the probability between two ends has a single maximum over the size of the error.
    An FRE of zero leaves the common offset alone.

    Args:
        target: (3,) float, in the fixed space, in mm.
        localization: The FLE; the default is isotropic and explains the residuals.
        common_bias_sd_mm: Standard deviation on each axis of an offset that all points share; 0
            for none, and both sides outside of the interval are equally likely then.
    """
    localization = localization or localization_error.isotropic_error(registration)
    targets = np.reshape(target, (1, -1))
    covariance = _propagated(registration, targets, localization.covariances)[0]
    return error_of_covariance(
        targets[0],
        covariance,
        fle_mm=localization.fle_mm,
        degrees_of_freedom=localization.degrees_of_freedom,
        common_bias_sd_mm=common_bias_sd_mm,
    )


def error_of_covariance(
    target: np.ndarray,
    covariance: np.ndarray,
    *,
    fle_mm: float,
    degrees_of_freedom: float,
    common_bias_sd_mm: float = COMMON_BIAS_SD_MM,
) -> TargetError:
    """Return the error at a target whose independent part has a covariance, as `target_error`.

    The covariance, (3, 3) float, mm², is without the common offset, and was computed from errors of
    points of `fle_mm`.
    """
    variances = np.linalg.eigvalsh(covariance).clip(min=0.0)
    independent = float(variances.sum())
    added, dof = common_bias_sd_mm**2, degrees_of_freedom
    below = (1 - CONFIDENCE) / 2
    lowest = _quantile(below, variances, dof, 0.0)
    if added > 0.0:
        below = distributions.widened_distribution(variances, dof, added)(lowest)
    x, y, z = (float(value) for value in target)
    return TargetError(
        target_mm=(x, y, z),
        fle_mm=fle_mm,
        expected_mm=math.sqrt(independent + 3.0 * added),
        independent_mm=math.sqrt(independent),
        interval_mm=(
            math.sqrt(lowest),
            math.sqrt(_quantile(below + CONFIDENCE, variances, dof, added)),
        ),
        common_bias_sd_mm=common_bias_sd_mm,
    )


def true_errors(
    world_to_head: np.ndarray, head_to_world: np.ndarray, points: np.ndarray
) -> np.ndarray:
    """Return how far a registration puts points (..., 3) from where they are, (..., 3), RAS mm.

    Both matrices are (4, 4) float, mm; `head_to_world` is where the head really is.
    """
    return transforms.apply(world_to_head @ head_to_world, points) - points


def true_target_error_mm(
    world_to_head: np.ndarray, head_to_world: np.ndarray, target: np.ndarray
) -> float:
    """Return the true TRE at a target (3,), mm: the length of its `true_errors`."""
    return float(np.linalg.norm(true_errors(world_to_head, head_to_world, target)))


def _quantile(probability: float, variances: np.ndarray, dof: float, added: float) -> float:
    """Return the quantile of TRE², mm², for variances along its principal axes."""
    if added == 0.0 and not variances.any():
        return 0.0
    if added == 0.0 and math.isfinite(dof):
        return distributions.ratio_quantile(probability, variances, dof)
    return distributions.widened_quantile(probability, variances, dof, added)


def _propagated(
    registration: Registration, targets: np.ndarray, covariances: np.ndarray
) -> np.ndarray:
    """Return the covariance (m, 3, 3) of TRE that FLE of covariances (n, 3, 3) causes.

    The errors change the fit's parameters, and these move the target, to first order.
    """
    fit = localization_error.fit_of_errors(registration)
    of_parameters = np.einsum("pni,nij,qnj->pq", fit, covariances, fit)
    center = registration.fixed_mm.mean(axis=0)
    array = np.asarray(targets, dtype=float)
    if array.ndim != 2 or array.shape[1] != 3 or not np.isfinite(array).all():
        raise InputError("Each target must be three finite coordinates (x, y, z in mm).")
    moved = motions(registration.kind, array - center)
    return moved @ of_parameters @ np.swapaxes(moved, 1, 2)


LEAST_SHARE_ALONG_SKIN = 0.1
"""Directions that lead off the skin at nearly all fiducials are left out: a bias there moves no
touch, and its estimate would be noise. The squared share along the skin is the mean over the
fiducials; it is at least 0.25 for every direction and task of Colin27."""
COMMON_BIAS_LEVEL = 0.05


@dataclass(frozen=True)
class CommonBias:
    """The common bias of a trial's touches: in RAS, from where they should be to where they are.

    p is the probability of one at least as large if the errors are independent, unbiased and equal
    along the skin (F test).
    """

    vector_mm: tuple[float, float, float]
    p: float

    @property
    def length_mm(self) -> float:
        return float(np.linalg.norm(self.vector_mm))

    @property
    def is_shown(self) -> bool:
        """Whether it is larger than the scatter of the touches explains."""
        return self.p < COMMON_BIAS_LEVEL


def true_touch_errors(
    touches_mm: np.ndarray, head_to_world: np.ndarray, fiducials_mm: np.ndarray
) -> np.ndarray:
    """Return how far touches (n, 3), World, are from their fiducials (n, 3), RAS, (n, 3), RAS mm.

    `head_to_world` is the true pose, (4, 4) float, mm.
    """
    try:
        world_to_head = transforms.inverse(head_to_world)
    except np.linalg.LinAlgError:
        raise InputError("The true pose of the head must be a rigid transform.") from None
    return transforms.apply(world_to_head, touches_mm) - fiducials_mm


def common_bias(errors_mm: np.ndarray, normals: np.ndarray) -> CommonBias:
    """Return the bias that best explains the errors (n, 3) of touches along the skin.

    `true_touch_errors` returns them. The unit normals (n, 3) of the skin are in the same frame.
    """
    along = _along_skin(normals)
    bias = np.einsum("inj,nj->i", bias_of_errors(normals), errors_mm)
    explained = float(np.sum((along @ bias) ** 2))
    left = float(np.sum(np.einsum("nij,nj->ni", along, errors_mm) ** 2)) - explained
    known = _axes(along)[0].size
    # Each error has two components along the skin.
    dof = 2 * len(normals) - known
    ratio = explained / known * dof / left if left > 0 else np.inf if explained > 0 else 0.0
    x, y, z = (float(value) for value in bias)
    return CommonBias((x, y, z), distributions.f_tail(ratio, known, dof))


def bias_of_errors(normals: np.ndarray) -> np.ndarray:
    """Return the linear map from the errors of touches to their common bias, (3, n, 3) float.

    It solves the least squares, b = (Σ Pᵢ)⁻¹ Σ Pᵢ eᵢ with Pᵢ = I − nᵢnᵢᵀ: a bias into the skin or
    off it moves no touch. The unit normals nᵢ of the skin are (n, 3) float.
    """
    along = _along_skin(normals)
    shares, axes = _axes(along)
    return np.einsum("ij,njk->ink", axes / shares @ axes.T, along) / len(normals)


def _along_skin(normals: np.ndarray) -> np.ndarray:
    """Return the projections onto the skin, (n, 3, 3) float."""
    return np.eye(3) - normals[:, :, None] * normals[:, None, :]


def _axes(along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the shares, (k,) float, and the axes along which a bias moves touches, (3, k)."""
    shares, axes = np.linalg.eigh(along.mean(axis=0))
    kept = shares >= LEAST_SHARE_ALONG_SKIN
    return shares[kept], axes[:, kept]
