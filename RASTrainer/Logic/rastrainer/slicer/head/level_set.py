"""From an image to a level set of the head's tissue, continued past the edges of the image."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from rastrainer.errors import InputError
from rastrainer.slicer.head import mask

CT_AIR, CT_SKIN = -1000.0, -475.0
"""Hounsfield units; the skin's surface is half-way between air and what lies under it."""

CT_LOW_QUANTILE, CT_LOW = 0.02, -500.0
TAIL_QUANTILE, TAIL_FACTOR = 0.999, 1.5
"""Values above that multiple of the quantile are few and bright (vessels, metal). They are clipped;
otherwise they alone would count as tissue."""


@dataclass(frozen=True)
class Tissue:
    """What is tissue in an image.

    Attributes:
        level: (i, j, k) float within ±1, positive in tissue; its zero lies between the voxels.
        threshold: that parts it from air, in the image's own values.
        isCt: whether the values are Hounsfield units.
    """

    level: np.ndarray
    threshold: float
    isCt: bool


def findTissue(values: np.ndarray, threshold: float | None, noise: float) -> Tissue:
    """Return the head's tissue, alone.

    Args:
        values: (i, j, k) float.
        threshold: None finds it: −475 HU of a CT, else by Otsu's method.
        noise: standard deviation of the smoothing, in voxels.

    Raises:
        InputError: nothing is above the threshold, or everything is.
    """
    isCt = isHounsfield(values)
    air = CT_AIR if isCt else 0.0
    aboveAir = np.clip(values, CT_AIR, None) - CT_AIR if isCt else values
    smooth = ndimage.gaussian_filter(aboveAir, noise, mode="nearest")
    if threshold is None:
        found = CT_SKIN - CT_AIR if isCt else mask.otsuThreshold(_withoutTail(smooth))
    else:
        found = threshold - air
    if threshold is None and found <= 0:
        raise InputError("No head was found: the image has no tissue that is brighter than air.")
    if found <= 0:
        raise InputError(f"The threshold must be above that of air, {air:g}: the skin is brighter.")
    level = np.clip(smooth / found - 1.0, -1.0, 1.0)
    # Filled first: the skull's dark layer may part the scalp from a brain that is larger.
    head = mask.largestBody(mask.withoutCavities(level > 0))
    level = np.where(head | (level <= 0), level, -1.0).astype(np.float32)
    return Tissue(level, found + air, isCt)


def isHounsfield(values: np.ndarray) -> bool:
    """Return whether an image has a CT's values: much of it is air at about −1000."""
    return bool(np.quantile(values[::2, ::2, ::2], CT_LOW_QUANTILE) < CT_LOW)


def _withoutTail(values: np.ndarray) -> np.ndarray:
    high = TAIL_FACTOR * float(np.quantile(values[::2, ::2, ::2], TAIL_QUANTILE))
    return np.minimum(values, high) if 0 < high < values.max() else values


TREND_LENGTH = 5
"""Over how many voxels the trend of an outline is measured."""

FASTEST_TREND = 2.0
"""Most voxels by which an outline shrinks per voxel at the image's edge; it never grows."""

ROUNDING = 1 / 6
"""Voxels per square voxel by which it shrinks ever faster, so that what is cut ends rounded."""


def continued(level: np.ndarray, margin: int) -> np.ndarray:
    """Pad a level set (positive inside) by `margin` voxels on every side.

    The first two axes are continued on both sides, the third upwards, all by the outline's own
    trend; downwards the lowest slice is repeated. Beyond the image the level is a distance in
    voxels, within ±1.
    """
    padded = np.pad(level, [(0, 0), (0, 0), (margin, 0)], mode="edge")
    for axis in (0, 1):
        padded = _continueEnd(padded, axis, margin)
        padded = np.flip(_continueEnd(np.flip(padded, axis), axis, margin), axis)
    return _continueEnd(padded, 2, margin)


def _continueEnd(level: np.ndarray, axis: int, margin: int) -> np.ndarray:
    """Append `margin` slices to the end of an axis."""
    slices = np.moveaxis(level, axis, 0)
    outline = _signedDistance(slices[-1])
    if outline is None:
        beyond = np.full((margin, *slices.shape[1:]), -1.0, level.dtype)
        return np.concatenate([level, np.moveaxis(beyond, 0, axis)], axis=axis)
    earlier = _signedDistance(slices[-1 - TREND_LENGTH])
    trend = (outline - earlier) / TREND_LENGTH if earlier is not None else np.zeros_like(outline)
    trend = np.clip(ndimage.gaussian_filter(trend, 2.0), -FASTEST_TREND, 0.0)
    steps = np.arange(1, margin + 1)[:, None, None]
    distance = outline + steps * trend - ROUNDING * steps**2
    beyond = np.clip(distance, -1.0, 1.0).astype(level.dtype)
    return np.concatenate([level, np.moveaxis(beyond, 0, axis)], axis=axis)


def _signedDistance(sliceLevel: np.ndarray) -> np.ndarray | None:
    """Return the distance to a slice's outline, positive inside; None for an empty slice."""
    inside = sliceLevel > 0
    if not inside.any():
        return None
    margin = 12
    # Repeated edges: where the head continues beyond this slice's own edge, there is no outline.
    padded = np.pad(inside, margin, mode="edge")
    distance = ndimage.distance_transform_edt(padded) - ndimage.distance_transform_edt(~padded)
    crop = (slice(margin, -margin),) * 2
    return ndimage.gaussian_filter(distance, 1.0)[crop]
