"""A list of points in mm, labeled or not, and how two lists are paired."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError

LABEL_LIMIT = 64
COORDINATE_LIMIT_MM = 1e6


@dataclass(frozen=True, eq=False)
class PointList:
    """Points in mm.

    Attributes:
        labels: Unique names of the points; empty if the points have none.
        points: (n, 3) float, finite, n ≥ 1.

    Raises:
        InputError: on construction, if they are invalid.
    """

    labels: tuple[str, ...]
    points: np.ndarray

    def __post_init__(self) -> None:
        points = np.array(self.points, dtype=float)
        if points.ndim != 2 or points.shape[1] != 3 or len(points) == 0:
            raise InputError("A list of points needs at least one point of three coordinates.")
        labels = tuple(self.labels)
        if not any(labels):
            labels = ()
        _check_labels(labels, len(points))
        bad = np.flatnonzero(~(np.abs(points) <= COORDINATE_LIMIT_MM).all(axis=1))
        if len(bad):
            name = json.dumps(labels[bad[0]]) if labels else str(bad[0] + 1)
            raise InputError(
                f"Point {name} has a coordinate that is not a number within "
                f"±{COORDINATE_LIMIT_MM:.0f} mm."
            )
        points.flags.writeable = False
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "labels", labels)


def pair(moving: PointList, fixed: PointList) -> tuple[tuple[str, ...], np.ndarray, np.ndarray]:
    """Return the labels and both (n, 3) point sets of two lists, paired row by row.

    Points are paired by label if both lists have labels, in the moving list's order; otherwise by
    order.

    Raises:
        InputError: a point has no partner.
    """
    if not (moving.labels and fixed.labels):
        if len(moving.points) != len(fixed.points):
            raise InputError(
                f"There are {len(moving.points)} moving and {len(fixed.points)} fixed points; "
                "without labels in both lists their order pairs them, so each needs its partner."
            )
        numbers = tuple(str(row + 1) for row in range(len(moving.points)))
        return moving.labels or fixed.labels or numbers, moving.points, fixed.points
    _check_partners(moving, fixed)
    row_of = {label: row for row, label in enumerate(fixed.labels)}
    return moving.labels, moving.points, fixed.points[[row_of[label] for label in moving.labels]]


def _check_partners(moving: PointList, fixed: PointList) -> None:
    unpaired = []
    for which, here, there in (
        ("moving", moving.labels, set(fixed.labels)),
        ("fixed", fixed.labels, set(moving.labels)),
    ):
        missing = [label for label in here if label not in there]
        if missing:
            unpaired.append(f"{_some(missing)} only in the {which} list")
    if unpaired:
        raise InputError(
            f"Points are paired by their labels, but {' and '.join(unpaired)}; "
            "give both lists the same labels, or none."
        )


def _check_labels(labels: tuple[str, ...], count: int) -> None:
    if labels and len(labels) != count:
        raise InputError(f"There are {len(labels)} labels for {count} points.")
    seen = set()
    for row, label in enumerate(labels):
        if not label:
            raise InputError(
                f"Point {row + 1} has no label although others have; label all points or none."
            )
        if len(label) > LABEL_LIMIT or not label.isprintable():
            raise InputError(
                f"The label of point {row + 1} must be printable text of at most {LABEL_LIMIT} "
                "characters."
            )
        if label in seen:
            raise InputError(f"The label {json.dumps(label)} is given to two points.")
        seen.add(label)


def _some(labels: list[str]) -> str:
    shown = ", ".join(labels[:5]) + (", …" if len(labels) > 5 else "")
    return f"{shown} {'is' if len(labels) == 1 else 'are'}"
