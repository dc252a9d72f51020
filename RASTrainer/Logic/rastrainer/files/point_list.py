"""Lists of points in mm, labeled or not, and how two lists pair up."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rastrainer.errors import InputError

LABEL_LIMIT = 64
COORDINATE_LIMIT_MM = 1e6


@dataclass(frozen=True, eq=False)
class PointList:
    """Points in mm, (n, 3) float, finite, n ≥ 1; `labels` are unique, or empty.

    `left_out` are places in the list, from 0, and labels of points that are not to be used: those
    that are deselected or not placed in Slicer. `labels` and `points` are without them.
    """

    labels: tuple[str, ...]
    points: np.ndarray
    left_out: Mapping[int, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        try:
            points = np.array(self.points, dtype=float)
        except (TypeError, ValueError, OverflowError):
            raise InputError("Points must be numbers, three for each (x, y, z in mm).") from None
        if self.left_out and len(points) == 0:
            raise InputError("All its points are deselected or not placed in Slicer.")
        if points.ndim != 2 or points.shape[1] != 3 or len(points) == 0:
            raise InputError("A list of points needs at least one point of three coordinates.")
        labels = tuple(self.labels) if any(self.labels) else ()
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

    @property
    def places(self) -> tuple[int, ...]:
        """The places of the points in the list as it was before some were left out."""
        places = range(len(self.points) + len(self.left_out))
        return tuple(place for place in places if place not in self.left_out)

    @property
    def left_out_names(self) -> tuple[str, ...]:
        return tuple(label or str(place + 1) for place, label in sorted(self.left_out.items()))


def points_of(points: object, problem: str) -> np.ndarray:
    """Return a read-only copy of points, (n, 3) float, mm; `problem` begins the error."""
    try:
        return PointList((), points).points  # type: ignore[arg-type]
    except InputError as error:
        raise InputError(f"{problem}: {error}") from None


def pair(moving: PointList, fixed: PointList) -> tuple[tuple[str, ...], np.ndarray, np.ndarray]:
    """Return the labels and both (n, 3) point sets of two lists, paired row by row.

    Points are paired by label if both lists have labels, in the moving list's order; otherwise by
    order. A point that is left out of one list is left out of both.
    """
    if moving.labels and fixed.labels:
        _check_partners(moving, fixed)
        keys: Sequence[Any] = moving.labels
        partners: Sequence[Any] = fixed.labels
    else:
        keys, partners = _places(moving, fixed)
    row_of = {key: row for row, key in enumerate(partners)}
    rows = [row for row, key in enumerate(keys) if key in row_of]
    others = [row_of[keys[row]] for row in rows]
    if not rows:
        raise InputError("No pair of points is left: all are deselected or not placed in Slicer.")
    if moving.labels:
        names = [moving.labels[row] for row in rows]
    elif fixed.labels:
        names = [fixed.labels[row] for row in others]
    else:
        names = [str(keys[row] + 1) for row in rows]
    return tuple(names), moving.points[rows], fixed.points[others]


def _places(moving: PointList, fixed: PointList) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return what pairs points by order: places in the whole lists, or among the points used."""
    sizes = [len(each.points) + len(each.left_out) for each in (moving, fixed)]
    if sizes[0] == sizes[1]:
        return moving.places, fixed.places
    if len(moving.points) == len(fixed.points):
        return (tuple(range(len(moving.points))),) * 2
    raise InputError(
        f"There are {len(moving.points)} moving and {len(fixed.points)} fixed points; "
        "without labels in both lists their order pairs them, so each needs its partner."
    )


def _check_partners(moving: PointList, fixed: PointList) -> None:
    left_out = {*moving.left_out.values(), *fixed.left_out.values()}
    unpaired = []
    for which, here, there in (
        ("moving", moving.labels, {*fixed.labels, *left_out}),
        ("fixed", fixed.labels, {*moving.labels, *left_out}),
    ):
        missing = [label for label in here if label not in there]
        if missing:
            shown = ", ".join(missing[:5]) + (", …" if len(missing) > 5 else "")
            verb = "is" if len(missing) == 1 else "are"
            unpaired.append(f"{shown} {verb} only in the {which} list")
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
