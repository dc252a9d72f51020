"""Finds the head's voxels: everything within the skin, without cavities and tunnels.

Tunnels are closed by filling as little as possible. The body is carved out of a larger body with
no tunnel, one voxel at a time, and only if that cannot change the topology ("simple points",
Bertrand and Malandain 1994): the result differs from the wanted body by thin membranes.
"""

from __future__ import annotations

import heapq
from functools import lru_cache

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy import ndimage

from rastrainer.errors import InputError


def otsuThreshold(values: np.ndarray) -> float:
    """Return the value that best separates air from tissue (Otsu 1979)."""
    counts, edges = np.histogram(values, bins=256)
    centers = (edges[:-1] + edges[1:]) / 2
    weight = np.cumsum(counts) / counts.sum()
    moment = np.cumsum(counts * centers) / counts.sum()
    spread = weight * (1 - weight)
    between = (moment[-1] * weight - moment) ** 2 / np.where(spread > 0, spread, np.inf)
    return float(centers[np.argmax(between)])


def largestBody(mask: np.ndarray) -> np.ndarray:
    """Return the largest connected part of a mask (6 neighbors)."""
    labels, count = ndimage.label(mask)
    if count == 0:
        raise InputError("No head was found: no voxel lies above the threshold.")
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    return labels == sizes.argmax()


def withoutCavities(mask: np.ndarray) -> np.ndarray:
    """Fill every hole that does not reach the image's border; the neck's cut counts as closed."""
    filled = mask.copy()
    filled[:, :, 0] = withoutHoles(filled[:, :, 0])
    return withoutHoles(filled)


def withoutHoles(mask: np.ndarray) -> np.ndarray:
    """Fill every hole that does not reach the border, as slow `ndimage.binary_fill_holes` does."""
    labels, count = ndimage.label(~mask)
    reaches = np.zeros(count + 1, dtype=bool)
    for axis in range(mask.ndim):
        for end in (0, -1):
            reaches[np.take(labels, end, axis)] = True
    reaches[0] = False
    return ~reaches[labels]


def closedByBall(mask: np.ndarray, radius: float) -> np.ndarray:
    """Return the morphological closing of a mask by a ball (radius in voxels).

    The mask is assumed to continue below the image, as the neck does.
    """
    margin = int(np.ceil(radius)) + 1
    padded = np.pad(mask, [(margin, margin), (margin, margin), (0, margin)])
    padded = np.pad(padded, [(0, 0), (0, 0), (margin, 0)], mode="edge")
    grown = squaredDistances(padded, radius) <= radius**2
    closed = squaredDistances(~grown, radius) > radius**2
    return closed[margin:-margin, margin:-margin, margin:-margin] | mask


def depthInside(mask: np.ndarray, most: float) -> np.ndarray:
    """Return each voxel's distance to the outside, in voxels, where it is at most `most`.

    Deeper voxels have more than `most`; the neck continues below the image.
    """
    margin = int(np.ceil(most))
    padded = np.pad(mask, [(0, 0), (0, 0), (margin, 0)], mode="edge")
    return np.sqrt(squaredDistances(~padded, most)[:, :, margin:].astype(np.float32))


def squaredDistances(mask: np.ndarray, most: float) -> np.ndarray:
    """Return the squared distance of each voxel to the mask, uint16, exact up to `most` voxels.

    Axis by axis, which is much faster than `ndimage.distance_transform_edt`.
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


# Voxels. Tunnels are rarely wider than the first, and the time grows with it.
_REACHES = (8, 16, 32, 64)
_FACES, _EDGES, _CORNERS = (ndimage.generate_binary_structure(3, n) for n in (1, 2, 3))
_MIDDLE = (1, 1, 1)


@lru_cache(maxsize=1 << 20)
def isSimple(cube: bytes) -> bool:
    """Return whether the middle voxel of 3×3×3 may be removed without a change of topology.

    The body is connected through faces, its outside through faces, edges and corners.
    """
    body = np.frombuffer(cube, bool).reshape(3, 3, 3)
    near = body & _EDGES
    near[_MIDDLE] = False
    parts, _ = ndimage.label(near)
    _, outsideCount = ndimage.label(~body, _CORNERS)
    return outsideCount == 1 and not body[_FACES].all() and len({*parts[_FACES & near]}) == 1


def carved(body: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Return `body` (i, j, k) carved toward `wanted` within it, with the topology of `body`.

    The voxels farthest from `wanted` go first, so that membranes stay where tunnels are narrow.
    """
    # A border of one voxel lets every voxel have 26 neighbors; the neck continues below.
    sides, below = [(1, 1), (1, 1), (0, 1)], [(0, 0), (0, 0), (1, 0)]
    padded = np.pad(np.pad(body, sides), below, mode="edge")
    keep = np.pad(np.pad(wanted, sides), below, mode="edge")
    keep[:, :, 0] = True
    voxels = bytearray(padded.tobytes())
    shape = padded.shape
    cubes = sliding_window_view(np.frombuffer(voxels, bool).reshape(shape), (3, 3, 3))
    candidates = padded & ~keep
    for reach in _REACHES:
        squared = squaredDistances(keep, reach)
        if squared[candidates].max(initial=0) <= reach**2:
            break
    isCandidate, distance = candidates.ravel(), squared.ravel()
    steps = ((np.argwhere(_CORNERS) - 1) @ (shape[1] * shape[2], shape[2], 1)).tolist()
    waiting = set(np.flatnonzero(candidates & ndimage.binary_dilation(~padded)).tolist())
    queue = [(-int(distance[index]), index) for index in waiting]
    heapq.heapify(queue)
    while queue:
        _, index = heapq.heappop(queue)
        waiting.discard(index)
        row, k = divmod(index, shape[2])
        i, j = divmod(row, shape[1])
        if isSimple(cubes[i - 1, j - 1, k - 1].tobytes()):
            voxels[index] = 0
            for other in (index + step for step in steps):
                if voxels[other] and isCandidate[other] and other not in waiting:
                    waiting.add(other)
                    heapq.heappush(queue, (-int(distance[other]), other))
    result = np.frombuffer(voxels, dtype=bool).reshape(shape)
    return result[1:-1, 1:-1, 1:-1].copy()
