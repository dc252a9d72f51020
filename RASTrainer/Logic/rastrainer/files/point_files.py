"""Points from files, CSV or Slicer's `.mrk.json`, and a number for each of them from CSV."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.csv_files import number_in, read_rows
from rastrainer.files.markups import read_markups
from rastrainer.files.point_list import COORDINATE_LIMIT_MM, PointList


def read_points(path: str | os.PathLike[str]) -> PointList:
    """Return the points of a file in mm; a name that ends in `.json` means a markups file.

    Points of markups files are in RAS; a CSV file is taken as it is. Its column `label` may be
    empty or absent.

    Raises:
        InputError: the file cannot be used; the sentence says what would be right.
    """
    if os.fspath(path).lower().endswith(".json"):
        return read_markups(path)
    rows = read_rows(path, ("x", "y", "z"), optional=("label",))
    limit = COORDINATE_LIMIT_MM
    points = [
        [number_in(path, line, cells, axis, -limit, limit) for axis in ("x", "y", "z")]
        for line, cells in rows
    ]
    try:
        return PointList(tuple(cells.get("label", "") for _, cells in rows), np.array(points))
    except InputError as error:
        raise InputError(f"The file {path} cannot be used: {error}") from None


def read_point_numbers(
    path: str | os.PathLike[str], column: str, labels: Sequence[str], lowest: float, highest: float
) -> np.ndarray:
    """Return the numbers of a column for points of these labels, (n,) float, in their order.

    Rows are found by their column `label`; without one, their order is that of the points. Further
    columns do not matter, so that a file of points may have the numbers in a column of its own.

    Raises:
        InputError: the file cannot be used, a number is not within the limits, or a point has none
            or two.
    """
    rows = read_rows(path, (column,), optional=("label",))
    numbers = [number_in(path, line, cells, column, lowest, highest) for line, cells in rows]
    named = [cells.get("label", "") for _, cells in rows]
    if not any(named):
        if len(numbers) != len(labels):
            raise InputError(
                f"The file {path} has {len(numbers)} rows without labels for {len(labels)} pairs "
                "of points; each pair needs its row."
            )
        return np.array(numbers)
    doubled = next((name for name in named if named.count(name) > 1), None)
    if doubled is not None:
        raise InputError(f"The file {path} has two rows for point {doubled[:64]!r}.")
    of_label = dict(zip(named, numbers, strict=True))
    missing = [label for label in labels if label not in of_label]
    if missing:
        raise InputError(f"The file {path} has no {column} for point {', '.join(missing[:5])}.")
    return np.array([of_label[label] for label in labels])
