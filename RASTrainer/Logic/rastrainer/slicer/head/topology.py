"""Make a voxel body free of tunnels, by filling as little as possible.

The body is carved out of a larger one that has no tunnel, one voxel at a time, and only where that
cannot change the topology ("simple points", Bertrand and Malandain 1994): what is left differs from
the wanted body by thin membranes that close its tunnels.
"""

from __future__ import annotations

import heapq
from functools import lru_cache

import numpy as np
from scipy import ndimage

from rastrainer.slicer.head import mask

_OFFSETS = [
    (x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) != (0, 0, 0)
]


def _bits(chosen) -> int:
    return sum(1 << index for index, offset in enumerate(_OFFSETS) if chosen(offset))


def _touching(offset, reach: int) -> int:
    """Return the neighbors, as bits, that share a face (reach 1) or at least a corner (3)."""

    def touches(other) -> bool:
        steps = [abs(a - b) for a, b in zip(offset, other, strict=True)]
        return max(steps) == 1 and sum(steps) <= reach

    return _bits(touches)


_FACES = _bits(lambda offset: sum(map(abs, offset)) == 1)
_FACES_AND_EDGES = _bits(lambda offset: sum(map(abs, offset)) <= 2)
_ALL = (1 << 26) - 1
# Voxels. Tunnels are rarely wider than the first, and the time grows with it.
_REACHES = (8, 16, 32, 64)
_BY_FACE = [_touching(offset, 1) for offset in _OFFSETS]
_BY_CORNER = [_touching(offset, 3) for offset in _OFFSETS]


@lru_cache(maxsize=1 << 20)
def is_simple(neighbors: int) -> bool:
    """Tell whether the middle voxel of 3×3×3 may be removed without a change of topology.

    Args:
        neighbors: the 26 neighbors that are set, one bit each; the body is connected through faces,
            its outside through faces, edges and corners.
    """
    inside = neighbors & _FACES_AND_EDGES
    outside = _ALL & ~neighbors
    if not inside & _FACES or not outside & _FACES:
        return False
    return _is_one(inside, inside & _FACES, _BY_FACE) and _is_one(outside, outside, _BY_CORNER)


def _is_one(members: int, wanted: int, touching: list[int]) -> bool:
    """Tell whether all `wanted` bits are connected with each other through `members`."""
    reached = frontier = wanted & -wanted
    while frontier:
        lowest = frontier & -frontier
        new = touching[lowest.bit_length() - 1] & members & ~reached
        reached |= new
        frontier = (frontier ^ lowest) | new
    return not wanted & ~reached


def carved(body: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Return `body` carved towards `wanted`, with the topology of `body`.

    The voxels farthest from `wanted` go first, so that membranes stay where tunnels are narrow.

    Args:
        body: (i, j, k) bool, contains `wanted`.
        wanted: (i, j, k) bool.
    """
    # A border of one voxel lets every voxel have 26 neighbors; the neck goes on below.
    sides, below = [(1, 1), (1, 1), (0, 1)], [(0, 0), (0, 0), (1, 0)]
    padded = np.pad(np.pad(body, sides), below, mode="edge")
    keep = np.pad(np.pad(wanted, sides), below, mode="edge")
    keep[:, :, 0] = True
    voxels = bytearray(padded.tobytes())
    candidates = padded & ~keep
    distance = _squared_distances(keep, candidates)
    border = candidates & ndimage.binary_dilation(~padded)
    _remove_simple(voxels, candidates.ravel(), distance.ravel(), border, _steps(padded.shape))
    result = np.frombuffer(voxels, dtype=bool).reshape(padded.shape)
    return result[1:-1, 1:-1, 1:-1].copy()


def _squared_distances(keep: np.ndarray, candidates: np.ndarray) -> np.ndarray:
    """Return squared distances to what is kept, exact for all candidates but the very far."""
    for reach in _REACHES:
        squared = mask.squared_distances(keep, reach)
        if squared[candidates].max(initial=0) <= reach**2:
            break
    return squared


def _steps(shape: tuple[int, ...]) -> list[int]:
    """Return how far each of the 26 neighbors is in the flat array."""
    strides = (shape[1] * shape[2], shape[2], 1)
    return [sum(a * b for a, b in zip(offset, strides, strict=True)) for offset in _OFFSETS]


def _remove_simple(
    voxels: bytearray,
    candidates: np.ndarray,
    distance: np.ndarray,
    border: np.ndarray,
    steps: list[int],
) -> None:
    waiting = set(np.flatnonzero(border).tolist())
    queue = [(-int(distance[index]), index) for index in waiting]
    heapq.heapify(queue)
    while queue:
        _, index = heapq.heappop(queue)
        waiting.discard(index)
        around = [index + step for step in steps]
        if not is_simple(sum(1 << bit for bit, other in enumerate(around) if voxels[other])):
            continue
        voxels[index] = 0
        for other in around:
            if voxels[other] and candidates[other] and other not in waiting:
                waiting.add(other)
                heapq.heappush(queue, (-int(distance[other]), other))
