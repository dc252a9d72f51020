"""Points that are unfit for registration: each error names the fault.

`rastrainer.registration.warnings` has faults that still allow a fit, such as a mirrored set.
"""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.point_list import COORDINATE_LIMIT_MM
from rastrainer.registration.fits import AFFINE, KINDS, MINIMUM_POINTS, RIGID

POINT_LIMIT = 1000
WEIGHT_SPAN = 1e12
"""The largest weight against the smallest: localization errors from 1 µm to 1 m."""
FLAT = 1e-3
"""A set is taken for a line (a plane) when its extent across is this small against that along."""


def check_points(
    moving: np.ndarray, fixed: np.ndarray, kind: str, labels: Sequence[str] | None = None
) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    """Return copies of both point sets, (n, 3) float in mm, and their labels.

    Raises:
        InputError: the kind is unknown; the counts differ or are too small or too large; a
            coordinate is no finite number within ±1 km; labels are missing or doubled; the points
            lie on a line or, for an affine registration, in a plane.
    """
    if kind not in KINDS:
        raise InputError(
            f"The registration type {json.dumps(str(kind)[:40])} is unknown; "
            f"it must be one of {', '.join(KINDS)}."
        )
    sets = {"moving": _as_points(moving, "moving"), "fixed": _as_points(fixed, "fixed")}
    _check_counts(len(sets["moving"]), len(sets["fixed"]), kind)
    names = _checked_labels(labels, len(sets["moving"]))
    for which, points in sets.items():
        _check_numbers(points, which, names)
        _check_extent(points, which, kind, names)
    return sets["moving"], sets["fixed"], names


def check_weights(
    weights: np.ndarray | None, kind: str, labels: Sequence[str]
) -> np.ndarray | None:
    """Return a copy of the weights, (n,) float that cannot be written to, or None for none.

    Raises:
        InputError: the fit is not rigid, there is not one weight above 0 for each label, or they
            differ too much for double precision.
    """
    if weights is None:
        return None
    if kind != RIGID:
        raise InputError(f"Weights are for rigid registrations; {kind} knows none.")
    try:
        array = np.array(weights, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InputError("The weights must be numbers, one for each pair of points.") from None
    if array.shape != (len(labels),):
        raise InputError(f"There must be {len(labels)} weights, one for each pair of points.")
    for label, weight in zip(labels, array, strict=True):
        if not (np.isfinite(weight) and weight > 0.0):
            raise InputError(f"The weight of point {label} must be a number above 0.")
    if array.max() > WEIGHT_SPAN * array.min():
        raise InputError(
            f"The largest weight may be at most {WEIGHT_SPAN:g} times the smallest; leave out the "
            "points that hardly count."
        )
    array.flags.writeable = False
    return array


def extents(points: np.ndarray) -> np.ndarray:
    """Return the RMS extents of the points along their principal axes, (3,) float, falling."""
    centered = points - points.mean(axis=0)
    return np.linalg.svd(centered, compute_uv=False) / np.sqrt(len(points))


def _as_points(points: object, which: str) -> np.ndarray:
    try:
        array = np.array(points, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InputError(
            f"The {which} points must be numbers, three for each point (x, y, z in mm)."
        ) from None
    if array.size == 0:
        raise InputError(f"There are no {which} points.")
    if array.ndim != 2 or array.shape[1] != 3:
        raise InputError(f"Each of the {which} points must have three coordinates (x, y, z in mm).")
    return array


def _check_counts(moving: int, fixed: int, kind: str) -> None:
    if moving != fixed:
        raise InputError(
            f"There are {moving} moving points and {fixed} fixed points; "
            "each must have its partner in the other list."
        )
    if moving < MINIMUM_POINTS[kind]:
        raise InputError(
            f"{kind.capitalize()} registration needs at least {MINIMUM_POINTS[kind]} pairs of "
            f"points; there {'is' if moving == 1 else 'are'} only {moving}."
        )
    if moving > POINT_LIMIT:
        raise InputError(f"There are {moving} pairs of points; at most {POINT_LIMIT} are accepted.")


def _checked_labels(labels: Sequence[str] | None, count: int) -> tuple[str, ...]:
    names = tuple(str(i + 1) for i in range(count)) if labels is None else tuple(map(str, labels))
    if len(names) != count:
        raise InputError(f"There are {len(names)} labels for {count} pairs of points.")
    for i, name in enumerate(names):
        if name in names[:i]:
            raise InputError(f"The label {json.dumps(name)} is given to two points.")
    return names


def _check_numbers(points: np.ndarray, which: str, labels: tuple[str, ...]) -> None:
    for label, point in zip(labels, points, strict=True):
        if not np.isfinite(point).all():
            raise InputError(
                f"Point {label} of the {which} points has a coordinate that is not a finite number."
            )
        if np.abs(point).max() > COORDINATE_LIMIT_MM:
            raise InputError(
                f"Point {label} of the {which} points has a coordinate beyond "
                f"±{COORDINATE_LIMIT_MM:.0f} mm."
            )


def _check_extent(points: np.ndarray, which: str, kind: str, labels: tuple[str, ...]) -> None:
    along, across, out_of_plane = extents(points)
    names = ", ".join(labels)
    # Doubles hold about 16 digits of the coordinates; what is smaller than that is no extent.
    if along <= 1e-12 * max(1.0, np.abs(points).max()):
        raise InputError(f"All {which} points ({names}) are at the same place.")
    if across < FLAT * along:
        raise InputError(
            f"The {which} points ({names}) lie on one line, so the rotation about it is open; "
            "add a point well away from it."
        )
    if kind == AFFINE and out_of_plane < FLAT * along:
        raise InputError(
            f"The {which} points ({names}) lie in one plane, so an affine registration is open; "
            "add a point well away from it, or choose rigid."
        )
