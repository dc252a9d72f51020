"""Where an image is tissue and where air, of MRI and CT."""

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
"""Values so many times above that quantile are few and bright (vessels, metal): they are clipped,
or they alone would count as tissue."""


@dataclass(frozen=True)
class Tissue:
    """What is tissue in an image.

    Attributes:
        level: (i, j, k) float within ±1, positive in tissue; its zero lies between the voxels.
        threshold: that parts it from air, in the image's own values.
        is_ct: whether the values are Hounsfield units.
    """

    level: np.ndarray
    threshold: float
    is_ct: bool


def find_tissue(values: np.ndarray, threshold: float | None, noise: float) -> Tissue:
    """Return the head's tissue, alone.

    Args:
        values: (i, j, k) float.
        threshold: None finds it: −475 HU of a CT, else by Otsu's method.
        noise: standard deviation of the smoothing, in voxels.

    Raises:
        InputError: nothing is above the threshold, or everything is.
    """
    is_ct = is_hounsfield(values)
    air = CT_AIR if is_ct else 0.0
    above_air = np.clip(values, CT_AIR, None) - CT_AIR if is_ct else values
    smooth = ndimage.gaussian_filter(above_air, noise, mode="nearest")
    if threshold is None:
        found = CT_SKIN - CT_AIR if is_ct else mask.otsu_threshold(_without_tail(smooth))
    else:
        found = threshold - air
    if threshold is None and found <= 0:
        raise InputError("No head was found: the image has no tissue that is brighter than air.")
    if found <= 0:
        raise InputError(f"The threshold must be above that of air, {air:g}: the skin is brighter.")
    level = np.clip(smooth / found - 1.0, -1.0, 1.0)
    # Filled first: the skull's dark layer may part the scalp from a brain that is larger.
    head = mask.largest_body(mask.without_cavities(level > 0))
    level = np.where(head | (level <= 0), level, -1.0).astype(np.float32)
    return Tissue(level, found + air, is_ct)


def is_hounsfield(values: np.ndarray) -> bool:
    """Tell whether an image has a CT's values: much of it is air at about −1000."""
    return bool(np.quantile(values[::2, ::2, ::2], CT_LOW_QUANTILE) < CT_LOW)


def _without_tail(values: np.ndarray) -> np.ndarray:
    high = TAIL_FACTOR * float(np.quantile(values[::2, ::2, ::2], TAIL_QUANTILE))
    return np.minimum(values, high) if 0 < high < values.max() else values
