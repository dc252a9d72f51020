"""Point lists from files: CSV with the header `label,x,y,z`, or Slicer's `.mrk.json`."""

from __future__ import annotations

import os

from rastrainer.csv_files import number_in, read_rows
from rastrainer.errors import InputError
from rastrainer.markups import read_markups
from rastrainer.point_list import COORDINATE_LIMIT_MM, PointList


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
        return PointList(tuple(cells.get("label", "") for _, cells in rows), points)
    except InputError as error:
        raise InputError(f"The file {path} cannot be used: {error}") from None
