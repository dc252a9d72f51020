"""Which voxels are head: everything within the skin, with the cavities below it filled."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from rastrainer.errors import InputError


def otsu_threshold(values: np.ndarray) -> float:
    """Return the value that best parts air from tissue (Otsu 1979, maximal variance between)."""
    counts, edges = np.histogram(values, bins=256)
    centers = (edges[:-1] + edges[1:]) / 2
    weight = np.cumsum(counts) / counts.sum()
    moment = np.cumsum(counts * centers) / counts.sum()
    spread = weight * (1 - weight)
    between = (moment[-1] * weight - moment) ** 2 / np.where(spread > 0, spread, np.inf)
    return float(centers[np.argmax(between)])


def largest_body(mask: np.ndarray) -> np.ndarray:
    """Return the largest connected part of a mask (6 neighbors).

    Raises:
        InputError: nothing is set.
    """
    labels, count = ndimage.label(mask)
    if count == 0:
        raise InputError("No head was found: no voxel lies above the threshold.")
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    return labels == sizes.argmax()


def without_cavities(mask: np.ndarray) -> np.ndarray:
    """Fill every hole that does not reach the image's border; the neck's cut counts as closed."""
    filled = mask.copy()
    filled[:, :, 0] = ndimage.binary_fill_holes(filled[:, :, 0])
    return ndimage.binary_fill_holes(filled)


def closed_by_ball(mask: np.ndarray, radius: float) -> np.ndarray:
    """Return the morphological closing of a mask by a ball (radius in voxels).

    The mask is taken to go on below the image, where the neck does.
    """
    margin = int(np.ceil(radius)) + 1
    padded = np.pad(mask, [(margin, margin), (margin, margin), (0, margin)])
    padded = np.pad(padded, [(0, 0), (0, 0), (margin, 0)], mode="edge")
    grown = ndimage.distance_transform_edt(~padded) <= radius
    closed = ndimage.distance_transform_edt(grown) > radius
    return closed[margin:-margin, margin:-margin, margin:-margin] | mask


def depth_inside(mask: np.ndarray) -> np.ndarray:
    """Return each voxel's distance to the outside, in voxels; the neck goes on below the image."""
    margin = 24
    padded = np.pad(mask, [(0, 0), (0, 0), (margin, 0)], mode="edge")
    return ndimage.distance_transform_edt(padded)[:, :, margin:]
