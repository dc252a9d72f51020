"""Continue a head past the edges of its image.

Scans often cut the tip of the nose, the ears and always the neck. At the neck the surface goes
straight on, to be cut flat afterwards; on the other sides it goes on as it was converging, until
it closes.
"""

from __future__ import annotations

import numpy as np
from scipy import ndimage

TREND_LENGTH = 5
"""Over how many voxels the trend of an outline is measured."""

FASTEST_TREND = 2.0
"""An outline shrinks by at most so many voxels a voxel at the image's edge, and never grows."""

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
        padded = _continue_end(padded, axis, margin)
        padded = np.flip(_continue_end(np.flip(padded, axis), axis, margin), axis)
    return _continue_end(padded, 2, margin)


def _continue_end(level: np.ndarray, axis: int, margin: int) -> np.ndarray:
    """Append `margin` slices to the end of an axis."""
    slices = np.moveaxis(level, axis, 0)
    outline = _signed_distance(slices[-1])
    if outline is None:
        beyond = np.full((margin, *slices.shape[1:]), -1.0, level.dtype)
        return np.concatenate([level, np.moveaxis(beyond, 0, axis)], axis=axis)
    earlier = _signed_distance(slices[-1 - TREND_LENGTH])
    trend = (outline - earlier) / TREND_LENGTH if earlier is not None else np.zeros_like(outline)
    trend = np.clip(ndimage.gaussian_filter(trend, 2.0), -FASTEST_TREND, 0.0)
    steps = np.arange(1, margin + 1)[:, None, None]
    distance = outline + steps * trend - ROUNDING * steps**2
    beyond = np.clip(distance, -1.0, 1.0).astype(level.dtype)
    return np.concatenate([level, np.moveaxis(beyond, 0, axis)], axis=axis)


def _signed_distance(slice_level: np.ndarray) -> np.ndarray | None:
    """Return the distance to a slice's outline, positive inside; None for an empty slice."""
    inside = slice_level > 0
    if not inside.any():
        return None
    margin = 12
    # Repeated edges: where the head goes on beyond this slice's own edge, there is no outline.
    padded = np.pad(inside, margin, mode="edge")
    distance = ndimage.distance_transform_edt(padded) - ndimage.distance_transform_edt(~padded)
    crop = (slice(margin, -margin),) * 2
    return ndimage.gaussian_filter(distance, 1.0)[crop]
