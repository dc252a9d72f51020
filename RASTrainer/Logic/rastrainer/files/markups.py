"""Point lists in files: Slicer's markups (`.mrk.json`, RAS mm) and CSV."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.point_list import COORDINATE_LIMIT_MM, PointList, read_point_cloud
from rastrainer.files.reading import number_in, read_json, read_rows
from rastrainer.files.writing import write_text
from rastrainer.json_checks import numbers

LIMIT_BYTES = 4 * 2**20
SCHEMA = (
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/"
    "Resources/Schema/markups-schema-v1.0.3.json#"
)
"""Identifies the format for Slicer; nothing is downloaded."""
_SCHEMA_MARK = "markups-schema-v1."
_TO_RAS = {"RAS": np.array([1.0, 1.0, 1.0]), "LPS": np.array([-1.0, -1.0, 1.0])}


def read_markups(path: str | os.PathLike[str]) -> PointList:
    """Return the points of a markups file with one point list, in RAS mm.

    Raises:
        InputError: unreadable, not a markups file, not exactly one point list, not in mm, or a
            point is not placed.
    """
    document = read_json(path, LIMIT_BYTES)
    try:
        return _point_list(document)
    except InputError as error:
        raise InputError(f"The file {path} cannot be used: {error}") from None


def write_markups(path: str | os.PathLike[str], point_list: PointList) -> None:
    """Write points in RAS mm as a markups file for Slicer, whole or not at all.

    Raises:
        InputError: the file cannot be written.
    """
    _write(path, {"type": "Fiducial"}, point_list)


def write_line(path: str | os.PathLike[str], name: str, ends: PointList) -> None:
    """Write a line between two points in RAS mm as a markups file for Slicer.

    Args:
        path: ends in `.mrk.json`.
        name: of the line's node.
        ends: two points.

    Raises:
        InputError: the file cannot be written.
    """
    _write(path, {"type": "Line", "name": name}, ends)


def _write(path: str | os.PathLike[str], kind: Mapping[str, str], point_list: PointList) -> None:
    labels = point_list.labels or tuple("" for _ in point_list.points)
    control_points = [
        {
            "id": str(row + 1),
            "label": label,
            "description": "",
            "associatedNodeID": "",
            "position": [float(value) for value in position],
            "orientation": [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            "selected": True,
            "locked": False,
            "visibility": True,
            "positionStatus": "defined",
        }
        for row, (label, position) in enumerate(zip(labels, point_list.points, strict=True))
    ]
    markup = {
        **kind,
        "coordinateSystem": "RAS",
        "coordinateUnits": "mm",
        "locked": False,
        "fixedNumberOfControlPoints": False,
        "labelFormat": "%d",
        "lastUsedControlPointNumber": len(control_points),
        "controlPoints": control_points,
        "measurements": [],
    }
    document = {"@schema": SCHEMA, "markups": [markup]}
    write_text(path, json.dumps(document, indent=1, ensure_ascii=False) + "\n")


def _point_list(document: Any) -> PointList:
    if not isinstance(document, Mapping) or _SCHEMA_MARK not in str(document.get("@schema")):
        raise InputError("it is not a markups file of Slicer (schema version 1).")
    markups = document.get("markups")
    if not isinstance(markups, list) or len(markups) != 1 or not isinstance(markups[0], Mapping):
        raise InputError("it must hold exactly one point list.")
    markup = markups[0]
    if markup.get("type") != "Fiducial":
        raise InputError("its markup must be a point list (type Fiducial).")
    if markup.get("coordinateUnits", "mm") not in ("mm", ["mm", "mm", "mm"]):
        raise InputError("its coordinates must be in mm.")
    # Slicer assumes LPS if a file has no coordinate system.
    system = markup.get("coordinateSystem", "LPS")
    if not isinstance(system, str) or system not in _TO_RAS:
        raise InputError("its coordinate system must be LPS or RAS.")
    control_points = markup.get("controlPoints")
    if not isinstance(control_points, list) or not control_points:
        raise InputError("it holds no points.")
    labels, positions = zip(
        *(_control_point(row, item) for row, item in enumerate(control_points)), strict=True
    )
    return PointList(labels, np.array(positions) * _TO_RAS[system])


def _control_point(row: int, item: Any) -> tuple[str, tuple[float, ...]]:
    if not isinstance(item, Mapping):
        raise InputError(f"point {row + 1} must be an object.")
    label = item.get("label", "")
    if not isinstance(label, str):
        raise InputError(f"the label of point {row + 1} must be text.")
    if item.get("positionStatus", "defined") != "defined":
        raise InputError(f"point {row + 1} {json.dumps(label[:64])} is not placed.")
    try:
        return label, numbers(3, COORDINATE_LIMIT_MM)(item.get("position"))
    except ValueError:
        raise InputError(
            f"the position of point {row + 1} must be three numbers within ±1e6 mm."
        ) from None


def read_points(path: str | os.PathLike[str]) -> PointList:
    """Return the points of a file in mm; a name in `.json` means markups, in `.ply` a point cloud.

    Markups are in RAS; a CSV file is taken as it is, its column `label` is optional. A point cloud
    is taken as it is, too, and has no labels.

    Raises:
        InputError: the file cannot be used.
    """
    if os.fspath(path).lower().endswith(".json"):
        return read_markups(path)
    if os.fspath(path).lower().endswith(".ply"):
        return _cloud(path)
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


def _cloud(path: str | os.PathLike[str]) -> PointList:
    points = read_point_cloud(path)
    try:
        return PointList((), points)
    except InputError as error:
        raise InputError(f"The file {path} cannot be used: {error}") from None


def read_point_numbers(
    path: str | os.PathLike[str], column: str, labels: Sequence[str], lowest: float, highest: float
) -> np.ndarray:
    """Return the numbers in a column for the points with these labels, (n,) float, in order.

    Rows are matched by the column `label`, or by order without one. Other columns are ignored, so
    the numbers may be in a file of points.

    Raises:
        InputError: the file cannot be used, a number is out of range, or a point has none or two.
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
