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
    filled[:, :, 0] = _filled(filled[:, :, 0])
    return _filled(filled)


def _filled(mask: np.ndarray) -> np.ndarray:
    """Fill every hole that does not reach the border, as slow `ndimage.binary_fill_holes` does."""
    labels, count = ndimage.label(~mask)
    reaches = np.zeros(count + 1, dtype=bool)
    for axis in range(mask.ndim):
        for end in (0, -1):
            reaches[np.take(labels, end, axis)] = True
    reaches[0] = False
    return ~reaches[labels]


def closed_by_ball(mask: np.ndarray, radius: float) -> np.ndarray:
    """Return the morphological closing of a mask by a ball (radius in voxels).

    The mask is taken to go on below the image, where the neck does.
    """
    margin = int(np.ceil(radius)) + 1
    padded = np.pad(mask, [(margin, margin), (margin, margin), (0, margin)])
    padded = np.pad(padded, [(0, 0), (0, 0), (margin, 0)], mode="edge")
    grown = squared_distances(padded, radius) <= radius**2
    closed = squared_distances(~grown, radius) > radius**2
    return closed[margin:-margin, margin:-margin, margin:-margin] | mask


def depth_inside(mask: np.ndarray, most: float) -> np.ndarray:
    """Return each voxel's distance to the outside, in voxels, where it is at most `most`.

    Deeper voxels have more than `most`; the neck goes on below the image.
    """
    margin = int(np.ceil(most))
    padded = np.pad(mask, [(0, 0), (0, 0), (margin, 0)], mode="edge")
    return np.sqrt(squared_distances(~padded, most)[:, :, margin:].astype(np.float32))


def squared_distances(mask: np.ndarray, most: float) -> np.ndarray:
    """Return the squared distance of each voxel to the mask, uint16, exact up to `most` voxels.

    Farther voxels have more than `most` squared. Axis by axis, so many times faster than
    `ndimage.distance_transform_edt`, whose result is exact however far a voxel is.
    """
    reach = int(most)
    squared = np.where(mask, np.uint16(0), np.uint16((reach + 1) ** 2))
    for axis in range(mask.ndim):
        # Sheet by sheet: one fits into the processor's cache, the whole image does not.
        for sheet in np.moveaxis(squared, axis, 0).swapaxes(0, 1):
            before = sheet.copy(order="K")
            for step in range(1, min(reach + 1, len(sheet))):
                farther = before + np.uint16(step**2)
                np.minimum(sheet[step:], farther[:-step], out=sheet[step:])
                np.minimum(sheet[:-step], farther[step:], out=sheet[:-step])
    return squared
