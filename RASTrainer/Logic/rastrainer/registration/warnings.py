"""Faults in paired points that a fit would hide: scale, mirror, order, bad touches; as warnings.

Each test compares the squared residuals of two explanations of the same points. Noise alone makes
the extended one significantly better in about one of 100,000 sets (an F test, corrected for the
number of explanations tried).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from rastrainer import transforms
from rastrainer.json_checks import text
from rastrainer.registration import fits
from rastrainer.registration.distributions import f_tail
from rastrainer.transforms import MM_PER_M

SAME_PLACE = 1e-3
"""Points nearer than this part of the set's extent count as one place (0.1 mm on a head)."""
NEARLY_FLAT = 0.05
UNITS = {MM_PER_M: "meters", 10.0: "centimeters", 25.4: "inches"}


@dataclass(frozen=True)
class RegistrationWarning:
    """Something that looks wrong with the points of a registration.

    Attributes:
        code: `nearly-collinear`, `nearly-coplanar`, `duplicate`, `scale`, `mirrored`, `order`,
            `outlier` or `poor-fit`.
        points: Labels of the points it is about.
        message: One sentence for the user, with the remedy.
    """

    code: str
    points: tuple[str, ...]
    message: Annotated[str, text(500)]


def find_warnings(
    moving: np.ndarray, fixed: np.ndarray, kind: str, labels: tuple[str, ...]
) -> Iterator[RegistrationWarning]:
    """Yield warnings about points that passed `check_points`.

    Except for flatness they are based on rigid fits, since a similarity fit hides a wrong scale and
    an affine one a mirror. Each detected fault is corrected before searching for the next.
    """
    names = ", ".join(labels)
    for which, points in (("moving", moving), ("fixed", fixed)):
        yield from _faults_of_one(points, which, kind, labels)
    scale = find_scale(moving, fixed)
    if scale is not None:
        message = (
            f"The fixed points ({names}) are {scale:.4g} times as far apart as the "
            f"moving points; {_unit_advice(scale)}."
        )
        yield RegistrationWarning("scale", labels, message)
        # The larger set is taken to be in mm, so that later sentences give true distances.
        moving, fixed = moving * max(scale, 1.0), fixed / min(scale, 1.0)
    if is_mirrored(moving, fixed):
        before, after = rigid_fre(moving, fixed), rigid_fre(mirrored(moving), fixed)
        message = (
            f"The moving points ({names}) are a mirror image of the fixed points "
            f"(rigid FRE {before:.1f} mm, mirrored {after:.1f} mm); check the sign of each axis "
            "and the coordinate system."
        )
        yield RegistrationWarning("mirrored", labels, message)
        moving = mirrored(moving)
    order = find_order(moving, fixed)
    if order is not None:
        yield _order(moving, fixed, order, labels)
        moving = moving[order]
    bad = find_bad_touches(moving, fixed)
    good = np.delete(np.arange(len(moving)), bad)
    if bad:
        before, after = rigid_fre(moving, fixed), rigid_fre(moving[good], fixed[good])
        matrix = fits.fit(moving[good], fixed[good], fits.RIGID)
    for i in bad:
        distance = np.linalg.norm(transforms.apply(matrix, moving[i]) - fixed[i])
        message = (
            f"Point {labels[i]} lies {distance:.1f} mm from where the {len(good)} points that fit "
            f"put it; touch it again or leave it out (rigid FRE {before:.1f} mm, without "
            f"{_listed([labels[j] for j in bad])} {after:.1f} mm)."
        )
        yield RegistrationWarning("outlier", (labels[i],), message)
    if is_poor_fit(moving[good], fixed[good]):
        after = rigid_fre(moving[good], fixed[good])
        message = (
            f"The points ({names}) do not match: the rigid FRE of {after:.1f} mm is more than a "
            "fifth of their extent; check that both lists are of the same task and in the same "
            "order."
        )
        yield RegistrationWarning("poor-fit", labels, message)


def _faults_of_one(
    points: np.ndarray, which: str, kind: str, labels: tuple[str, ...]
) -> Iterator[RegistrationWarning]:
    these = f"The {which} points ({', '.join(labels)}) lie nearly"
    along, across, out_of_plane = fits.extents(points)
    if across < NEARLY_FLAT * along:
        message = (
            f"{these} on one line, so the rotation about it is uncertain; add a point well away "
            "from it."
        )
        yield RegistrationWarning("nearly-collinear", labels, message)
    elif kind == fits.AFFINE and out_of_plane < NEARLY_FLAT * along:
        message = (
            f"{these} in one plane, so the affine registration is uncertain across it; add a "
            "point well away from it or choose rigid."
        )
        yield RegistrationWarning("nearly-coplanar", labels, message)
    same = same_places(points)
    twins = tuple(label for label, row in zip(labels, same, strict=True) if row.any())
    if twins:
        message = (
            f"Points {_listed(twins)} of the {which} points are at the same place as another of "
            "them; touch or place each fiducial once."
        )
        yield RegistrationWarning("duplicate", twins, message)


def same_places(points: np.ndarray) -> np.ndarray:
    """Return which points, (n, n) bool, are at the same place as which others."""
    limit = SAME_PLACE * np.linalg.norm(fits.extents(points))
    distances = np.linalg.norm(points[:, None] - points[None], axis=2)
    return (distances <= limit) & ~np.eye(len(points), dtype=bool)


def _unit_advice(scale: float) -> str:
    for factor, unit in UNITS.items():
        if abs(scale / factor - 1) < 0.05:
            return f"the moving points seem to be in {unit}, they must be in millimeters"
        if abs(scale * factor - 1) < 0.05:
            return f"the fixed points seem to be in {unit}, they must be in millimeters"
    return "check that both are in millimeters and of the same head"


def _order(
    moving: np.ndarray, fixed: np.ndarray, order: np.ndarray, labels: tuple[str, ...]
) -> RegistrationWarning:
    rows = np.arange(len(order))
    moved = tuple(labels[i] for i in rows[order != rows])
    before, after = rigid_fre(moving, fixed), rigid_fre(moving[order], fixed)
    if len(moved) == 2:
        fault = f"Points {_listed(moved)} seem to be exchanged; exchange their labels"
    elif (order == rows[::-1]).all():
        fault = (
            f"The moving points ({', '.join(labels)}) are in reverse order; turn one list around"
        )
    else:
        fault = (
            f"The moving points ({', '.join(labels)}) start elsewhere in the list: the one "
            f"at {labels[order[0]]} belongs to the fixed point {labels[0]}; start both lists alike"
        )
    message = f"{fault} (rigid FRE {before:.1f} mm, in the right order {after:.1f} mm)."
    return RegistrationWarning("order", moved, message)


def _listed(names: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


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
    scale = fits.symmetric_scale(moving, fixed)
    # Distances of neighbors in the lists: one bad touch hardly moves their median.
    distances = [
        np.linalg.norm(np.roll(points, shift, axis=0) - points, axis=1)
        for shift in range(1, min(len(moving), WORST_POINTS))
        for points in (moving, fixed)
    ]
    along, across = np.concatenate(distances[0::2]), np.concatenate(distances[1::2])
    usable = (along > 0) & (across > 0)
    typical = float(np.median(across[usable] / along[usable]))
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
    rows = np.arange(len(moving))
    pairs = list(itertools.combinations(_worst_points(moving, fixed, np.ones(len(rows))), 2))
    orders = np.tile(rows, (len(pairs), 1))
    for exchanged, (i, j) in zip(orders, pairs, strict=True):
        exchanged[[i, j]] = j, i
    if len(rows) <= ORDERS_LIMIT:
        rotated = (np.roll(rows, shift) for shift in range(1, len(rows)))
        orders = np.vstack([orders, rows[::-1], *rotated])
    squares = fits.rigid_sums_of_squares(moving[orders], fixed, np.ones(len(moving)))
    best = int(np.argmin(squares))
    before, dof = _squares(moving, fixed), 3 * len(moving) - 6
    if not _explains(before, squares[best], 3, dof, len(orders), fixed):
        return None
    if is_poor_fit(moving[orders[best]], fixed):
        return None
    if best < len(pairs) and not _both_fit(moving, fixed, orders[best], squares[best]):
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
    return rigid_fre(moving, fixed) > POOR_FIT * float(np.linalg.norm(fits.extents(fixed)))


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
    squares = fits.rigid_sums_of_squares(moving, fixed, tried)
    best = int(np.argmin(squares))
    before = float(fits.rigid_sums_of_squares(moving, fixed, weights))
    if _explains(before, squares[best], 3 * size, 3 * left - 6, len(subsets), fixed):
        return tuple(int(i) for i in subsets[best])
    return None


def _both_fit(moving: np.ndarray, fixed: np.ndarray, order: np.ndarray, squares: float) -> bool:
    """Return whether two exchanged points fit as well as the others.

    One bad touch beyond another fiducial also gains by an exchange, but does not fit afterward.
    """
    kept = (order == np.arange(len(order))).astype(float)
    left = int(kept.sum())
    if left < 4:
        return True
    others = float(fits.rigid_sums_of_squares(moving, fixed, kept))
    return not _explains(squares, others, 6, 3 * left - 6, 1, fixed)


def _worst_points(moving: np.ndarray, fixed: np.ndarray, weights: np.ndarray) -> np.ndarray:
    used = weights > 0
    matrix = fits.fit(moving[used], fixed[used], fits.RIGID)
    distances = np.linalg.norm(transforms.apply(matrix, moving) - fixed, axis=1)
    return np.sort(np.argsort(-distances * weights, kind="stable")[:WORST_POINTS])


def _explains(
    before: float, after: float, parameters: int, dof: int, tries: int, fixed: np.ndarray
) -> bool:
    """Return whether `parameters` more parameters reduce the squares more than noise would."""
    floor = len(fixed) * (NOISE_FLOOR * np.linalg.norm(fits.extents(fixed))) ** 2
    ratio = max(before - after, 0.0) / parameters / ((after + floor) / dof)
    return tries * f_tail(float(ratio), parameters, dof) < FALSE_ALARM


def _squares(moving: np.ndarray, fixed: np.ndarray, handedness: int = 1) -> float:
    return float(fits.rigid_sums_of_squares(moving, fixed, np.ones(len(moving)), handedness))
