"""Detects faults in paired points that a fit would hide: scale, mirror, order, bad touches.

Each test compares the squared residuals of two explanations of the same points. Noise alone makes
the extended one significantly better in about one of 100,000 sets (an F test, corrected for the
number of explanations tried).
"""

from __future__ import annotations

import itertools

import numpy as np

from rastrainer import transforms
from rastrainer.registration.checks import extents
from rastrainer.registration.distributions import f_tail
from rastrainer.registration.fits import RIGID, fit, rigid_sums_of_squares, symmetric_scale

FALSE_ALARM = 1e-5
NOISE_FLOOR = 5e-4
"""Touches are never exact: noise is taken as at least this part of the points' extent."""
COARSE_SCALE = 1.5
FINE_SCALE = 1.02
POOR_FIT = 0.2
WORST_POINTS = 20
"""Only the points with the largest residuals are tried as exchanged or bad, to bound the work."""
ORDERS_LIMIT = 100


def find_scale(moving: np.ndarray, fixed: np.ndarray) -> float | None:
    """Return how many times larger the fixed points are, or None if they match.

    Both the extents and the typical distance must differ: one bad touch far away changes the
    former, a wrong order the latter. A scale near 1 counts only if noise cannot explain it.
    """
    scale = symmetric_scale(moving, fixed)
    typical = _median_distance_ratio(moving, fixed)
    if min(scale, typical) > COARSE_SCALE or max(scale, typical) < 1 / COARSE_SCALE:
        return typical
    if not (min(scale, typical) > FINE_SCALE or max(scale, typical) < 1 / FINE_SCALE):
        return None
    dof = 3 * len(moving) - 7
    before, after = _squares(moving, fixed), _squares(scale * moving, fixed)
    return scale if _explains(before, after, 1, dof, 1, fixed) else None


def is_mirrored(moving: np.ndarray, fixed: np.ndarray) -> bool:
    """Return whether the points match only as a mirror image."""
    dof = 3 * len(moving) - 6
    before = _squares(moving, fixed)
    return _explains(before, _squares(moving, fixed, handedness=-1), 3, dof, 1, fixed)


def mirrored(points: np.ndarray) -> np.ndarray:
    """Return the points with their first coordinate negated."""
    return points * np.array([-1.0, 1.0, 1.0])


def find_order(moving: np.ndarray, fixed: np.ndarray) -> np.ndarray | None:
    """Return the order, (n,) int, in which the moving points match, or None if they already do.

    Candidates are two exchanged points, the reversed list, and the rotated list. An order with a
    poor fit is not returned.
    """
    exchanges, others = _exchanges(moving, fixed), _other_orders(len(moving))
    orders = np.concatenate([exchanges, others])
    squares = rigid_sums_of_squares(moving[orders], fixed, np.ones(len(moving)))
    best = int(np.argmin(squares))
    before, dof = _squares(moving, fixed), 3 * len(moving) - 6
    if not _explains(before, squares[best], 3, dof, len(orders), fixed):
        return None
    if is_poor_fit(moving[orders[best]], fixed):
        return None
    if best < len(exchanges) and not _both_fit(moving, fixed, orders[best], squares[best]):
        return None
    return orders[best]


def find_bad_touches(moving: np.ndarray, fixed: np.ndarray) -> tuple[int, ...]:
    """Return the rows of the few points that do not match the others.

    Points are left out one at a time, or in pairs if two bad touches mask each other.
    """
    bad: tuple[int, ...] = ()
    while len(bad) < len(moving) // 4:
        found = next(
            (rows for size in (1, 2) if (rows := _worst_subset(moving, fixed, bad, size))), None
        )
        if found is None:
            break
        bad += found
    return tuple(sorted(bad))


def rigid_fre(moving: np.ndarray, fixed: np.ndarray) -> float:
    """Return the fiducial registration error of the best rigid fit, in the points' unit."""
    return float(np.sqrt(_squares(moving, fixed) / len(moving)))


def is_poor_fit(moving: np.ndarray, fixed: np.ndarray) -> bool:
    """Return whether the FRE of the best rigid fit exceeds a fifth of the points' extent."""
    return rigid_fre(moving, fixed) > POOR_FIT * float(np.linalg.norm(extents(fixed)))


def _worst_subset(
    moving: np.ndarray, fixed: np.ndarray, bad: tuple[int, ...], size: int
) -> tuple[int, ...] | None:
    left = len(moving) - len(bad) - size
    if left < 3:
        return None
    weights = np.ones(len(moving))
    weights[list(bad)] = 0.0
    candidates = [i for i in _worst_points(moving, fixed, weights) if weights[i]]
    subsets = np.array(list(itertools.combinations(candidates, size)))
    tried = np.repeat(weights[None], len(subsets), axis=0)
    np.put_along_axis(tried, subsets, 0.0, axis=1)
    squares = rigid_sums_of_squares(moving, fixed, tried)
    best = int(np.argmin(squares))
    before = float(rigid_sums_of_squares(moving, fixed, weights))
    if _explains(before, squares[best], 3 * size, 3 * left - 6, len(subsets), fixed):
        return tuple(int(i) for i in subsets[best])
    return None


def _exchanges(moving: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    worst = _worst_points(moving, fixed, np.ones(len(moving)))
    pairs = list(itertools.combinations(worst, 2))
    orders = np.tile(np.arange(len(moving)), (len(pairs), 1))
    for order, (i, j) in zip(orders, pairs, strict=True):
        order[[i, j]] = j, i
    return orders


def _other_orders(count: int) -> np.ndarray:
    if count > ORDERS_LIMIT:
        return np.empty((0, count), dtype=int)
    rows = np.arange(count)
    return np.array([rows[::-1], *(np.roll(rows, shift) for shift in range(1, count))])


def _both_fit(moving: np.ndarray, fixed: np.ndarray, order: np.ndarray, squares: float) -> bool:
    """Return whether two exchanged points fit as well as the others.

    One bad touch beyond another fiducial also gains by an exchange, but does not fit afterwards.
    """
    kept = (order == np.arange(len(order))).astype(float)
    left = int(kept.sum())
    if left < 4:
        return True
    others = float(rigid_sums_of_squares(moving, fixed, kept))
    return not _explains(squares, others, 6, 3 * left - 6, 1, fixed)


def _worst_points(moving: np.ndarray, fixed: np.ndarray, weights: np.ndarray) -> np.ndarray:
    used = weights > 0
    matrix = fit(moving[used], fixed[used], RIGID)
    distances = np.linalg.norm(transforms.apply(matrix, moving) - fixed, axis=1)
    return np.sort(np.argsort(-distances * weights, kind="stable")[:WORST_POINTS])


def _explains(
    before: float, after: float, parameters: int, dof: int, tries: int, fixed: np.ndarray
) -> bool:
    """Return whether `parameters` more parameters reduce the squares more than noise would."""
    floor = len(fixed) * (NOISE_FLOOR * np.linalg.norm(extents(fixed))) ** 2
    ratio = max(before - after, 0.0) / parameters / ((after + floor) / dof)
    return tries * f_tail(float(ratio), parameters, dof) < FALSE_ALARM


def _squares(moving: np.ndarray, fixed: np.ndarray, handedness: int = 1) -> float:
    return float(rigid_sums_of_squares(moving, fixed, np.ones(len(moving)), handedness))


def _median_distance_ratio(moving: np.ndarray, fixed: np.ndarray) -> float:
    """Return the median of fixed over moving distances of neighbors in the lists.

    One bad touch, however far off, does not move the median much.
    """
    distances = [
        np.linalg.norm(np.roll(points, shift, axis=0) - points, axis=1)
        for shift in range(1, min(len(moving), WORST_POINTS))
        for points in (moving, fixed)
    ]
    along, across = np.concatenate(distances[0::2]), np.concatenate(distances[1::2])
    usable = (along > 0) & (across > 0)
    return float(np.median(across[usable] / along[usable]))
