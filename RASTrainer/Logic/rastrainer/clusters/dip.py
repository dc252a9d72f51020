"""Hartigans' dip: how far a sample is from every distribution with a single peak (1985)."""

from __future__ import annotations

import functools

import numpy as np

REFERENCE_SAMPLES = 2000


def dip(values: np.ndarray) -> float:
    """Return the largest distance of the empirical distribution of (n,) values from its nearest
    unimodal one.

    The peak is enclosed from both sides: left of it a unimodal distribution function is convex,
    right of it concave. Where the greatest convex minorant and the least concave majorant of what
    is still open are farthest apart, the next, shorter interval begins and ends.
    """
    x, counts = np.unique(np.asarray(values, dtype=float), return_counts=True)
    n = len(values)
    above = np.cumsum(counts) / n
    below = above - counts / n
    low, high, widest = 0, len(x) - 1, 1 / n
    while True:
        convex = low + _hull(x[low : high + 1], below[low : high + 1], 1)
        concave = low + _hull(x[low : high + 1], above[low : high + 1], -1)
        over_convex = above[concave] - np.interp(x[concave], x[convex], below[convex])
        under_concave = np.interp(x[convex], x[concave], above[concave]) - below[convex]
        if over_convex.max() > under_concave.max():
            apart, right = over_convex.max(), concave[over_convex.argmax()]
            left = convex[convex <= right].max()
        else:
            apart, left = under_concave.max(), convex[under_concave.argmax()]
            right = concave[concave >= left].min()
        if apart <= widest:
            return float(widest / 2)
        # But for its ends: many equal values may well be the peak.
        rising = np.interp(x[low:left], x[convex], below[convex])
        falling = np.interp(x[right + 1 : high + 1], x[concave], above[concave])
        widest = max(
            widest,
            (above[low:left] - rising).max(initial=0.0),
            (falling - below[right + 1 : high + 1]).max(initial=0.0),
        )
        if (left, right) == (low, high):
            return float(widest / 2)
        low, high = left, right


def dip_p(values: np.ndarray) -> float:
    """Return how often (n,) values of a uniform distribution have so large a dip.

    Of all distributions with a single peak the uniform one has the largest dips, so that this p is
    too large for every other one, whether skewed or heavy-tailed, and never too small.
    """
    reference = _uniform_dips(len(values))
    larger = len(reference) - np.searchsorted(reference, dip(values) - 1e-12)
    return float((larger + 1) / (len(reference) + 1))


@functools.lru_cache(maxsize=64)
def _uniform_dips(n: int) -> np.ndarray:
    random = np.random.default_rng(n)
    return np.sort([dip(row) for row in random.random((REFERENCE_SAMPLES, n))])


def _hull(x: np.ndarray, y: np.ndarray, side: int) -> np.ndarray:
    """Return the rows of the corners of the lower (side 1) or upper (-1) hull of sorted points."""
    corners: list[int] = []
    for row in range(len(x)):
        while len(corners) > 1:
            a, b = corners[-2:]
            turn = (y[b] - y[a]) * (x[row] - x[a]) - (y[row] - y[a]) * (x[b] - x[a])
            if side * turn < 0:
                break
            corners.pop()
        corners.append(row)
    return np.array(corners)
