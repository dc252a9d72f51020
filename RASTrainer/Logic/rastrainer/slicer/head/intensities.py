"""Interprets a volume's values: Hounsfield units or not, and values that were not measured."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from rastrainer.slicer.head import mask
from rastrainer.slicer.head.volume import SPACING_MM, HeadBody, Volume, sampled

CT_AIR = -1000.0
"""Hounsfield units."""

CT_BONE = 300.0
"""Hounsfield units; cortical bone has more, contrast in vessels may too."""

STORED_ZERO = 1024.0
"""Value that 0 HU is stored as; a rescale intercept of −1024 takes it off again."""

_CT_LOW_QUANTILE, _CT_LOW = 0.02, -500.0
_CT_MIDDLE = (-100.0, 300.0)
"""Hounsfield units of the middle of a head, or of a phantom's plastic."""
_STORED_AIR, _STORED_TISSUE = (-1.0, 60.0), (1000.0, 1110.0)
_CT_SPREAD, _LEAST_BONE = 100.0, 0.005
"""Hounsfield units between the quartiles in the middle of a head: gray and white matter are 10
apart, while in MRI they and the fluid differ by a third; and the least share of bone in a head."""


def isHounsfield(values: np.ndarray) -> bool:
    """Return whether an image has a CT's values: air at about −1000, and around 0 in the middle."""
    coarse = values[::2, ::2, ::2]
    if np.quantile(coarse, _CT_LOW_QUANTILE) >= _CT_LOW:
        return False
    low, high = _CT_MIDDLE
    return bool(low <= np.median(_middle(coarse, _CT_LOW)) <= high)


def cleaned(volume: Volume) -> tuple[Volume, float, list[str]]:
    """Return a volume of measured values alone, changed in place, an offset, and warnings.

    A CT is in Hounsfield units; the offset was added to all values.
    """
    values = volume.values
    _replaceFill(values)
    if isHounsfield(values):
        return volume, 0.0, []
    if _isStoredCt(values):
        values -= STORED_ZERO
        warning = (
            "The values look like those of a CT without its rescale intercept: air at 0, soft "
            f"tissue at about 1050. {STORED_ZERO:g} was subtracted to get Hounsfield units; if it "
            "is no CT, do not use the head."
        )
        return volume, -STORED_ZERO, [warning]
    # An MRI's few values that have overflowed leave few gray levels for tissue.
    low, high = np.quantile(values[::2, ::2, ::2], (_OUTLIERS, 1.0 - _OUTLIERS))
    if high > low:
        values[values < low - _FAR_BELOW * (high - low)] = low
        np.minimum(values, high + _FAR_ABOVE * (high - low), out=values)
    return volume, 0.0, []


FEWEST_FILL = 0.005
"""Share of the voxels that have exactly the value of a corner, from which on this is no chance."""

_UNLIKE = 0.1
"""Difference between a fill and its neighbors, as a share of the range of values."""

_DARK = 0.25
_DARKER_THAN_AIR = 0.05


def _replaceFill(values: np.ndarray) -> None:
    """Give air's value to what a program has put where nothing was measured.

    Such a fill has one value, from the image's corners inward. It is not the air around the head if
    it is brighter than the darkest that was measured, or if air lies between it and the head.
    """
    for corner in np.unique(values[np.ix_(*[(0, -1)] * 3)]):
        coarse = values[::2, ::2, ::2]
        isFill = coarse == corner
        measured = coarse[~isFill]
        if isFill.mean() < FEWEST_FILL or not measured.size:
            continue
        low, high = np.quantile(measured, (0.02, 0.9))
        beside = coarse[ndimage.binary_dilation(isFill, iterations=2) & ~isFill]
        unlike, dark = _UNLIKE * (high - low), low + _DARK * (high - low)
        isBrighter = np.mean(measured < corner - unlike) > _DARKER_THAN_AIR
        isDarker = corner < low - unlike and np.median(beside) < dark
        if isBrighter or isDarker:
            values[~mask.withoutHoles(values != corner)] = low


def _isStoredCt(values: np.ndarray) -> bool:
    coarse = values[::2, ::2, ::2]
    air = float(np.quantile(coarse, _CT_LOW_QUANTILE))
    if not _STORED_AIR[0] <= air <= _STORED_AIR[1]:
        return False
    inside = coarse > STORED_ZERO + _CT_LOW
    if not inside.any():
        return False
    first, middle, third = np.quantile(_middle(coarse, STORED_ZERO + _CT_LOW), (0.25, 0.5, 0.75))
    bone = np.mean(coarse[inside] > STORED_ZERO + CT_BONE)
    low, high = _STORED_TISSUE
    return bool(low <= middle <= high and third - first < _CT_SPREAD and bone > _LEAST_BONE)


def _middle(values: np.ndarray, above: float) -> np.ndarray:
    box = ndimage.find_objects((values > above).astype(np.uint8))
    if not box:
        return values
    thirds = []
    for part in box[0]:
        third = (part.stop - part.start) // 3
        thirds.append(slice(part.start + third, part.stop - third))
    return values[tuple(thirds)]


_OUTLIERS, _FAR_BELOW, _FAR_ABOVE = 0.01, 0.5, 4.0
"""The share of voxels at each end that may be outliers, and how far these lie, in multiples of the
range between: less deep below than high above, where vessels and metal are."""


_STEP = 2
_SHALLOW_MM, _DEEP_MM, _UPPER_MM = range(4, 20, 2), 24.0, 80.0
_DIP = 0.7


def skullWarnings(volume: Volume, head: HeadBody) -> list[str]:
    """Return a warning if no skull is seen in the upper head: a dark layer of MRI, bright in CT."""
    body = head.body[::_STEP, ::_STEP, ::_STEP]
    gridToRas = np.diag([_STEP * SPACING_MM] * 3 + [1.0])
    gridToRas[:3, 3] = head.origin
    values = sampled(volume, gridToRas, body.shape)
    depth = mask.depthInside(body, _DEEP_MM / _STEP) * _STEP * SPACING_MM
    heights = np.flatnonzero(body.any(axis=(0, 1)))
    body = body & (np.arange(body.shape[2]) > heights[-1] - _UPPER_MM / _STEP)
    if head.isCt:
        hasSkull = np.mean(values[body & (depth < _DEEP_MM)] > CT_BONE) > _LEAST_BONE
    else:
        air = float(values.min())
        layers = [values[body & (depth >= d) & (depth < d + _STEP)] for d in _SHALLOW_MM]
        deep = np.median(values[body & (depth >= _DEEP_MM)]) - air
        hasSkull = min(np.median(layer) - air for layer in layers) < _DIP * deep
    if hasSkull:
        return []
    return [
        "No skull is seen under the surface. If the image shows a brain alone (skull-stripped), "
        "this surface is not the skin: use the image from before the skull was taken off."
    ]
