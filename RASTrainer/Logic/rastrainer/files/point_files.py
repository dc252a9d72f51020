"""Files of points in mm: 3D Slicer's markups (`.mrk.json`) and `.fcsv`, CSV and PLY."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.csv_table import POSITION_STATUS, CsvTable, number_in, read_table
from rastrainer.files.ply import LPS_TO_RAS, read_point_cloud
from rastrainer.files.point_list import COORDINATE_LIMIT_MM, PointList
from rastrainer.files.reading import read_json
from rastrainer.files.writing import write_text
from rastrainer.json_checks import numbers

MARKUPS_LIMIT_BYTES = 4 * 2**20
SCHEMA = (
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/"
    "Resources/Schema/markups-schema-v1.0.3.json#"
)
"""Identifies the format for Slicer; nothing is downloaded."""
_SCHEMA_MARK = "markups-schema-v1."
_PLACED = "defined"
_STATUSES = ("undefined", "preview", "missing", _PLACED)


def read_markups(path: str | os.PathLike[str], *, allow_left_out: bool = False) -> PointList:
    """Return the points of a markups file with one point list, in RAS mm.

    With `allow_left_out`, points may be deselected or not placed; these are left out.
    """
    document = read_json(path, MARKUPS_LIMIT_BYTES)
    try:
        point_list = _point_list(document)
        if point_list.left_out and not allow_left_out:
            raise InputError(
                "Slicer would not use all of its points; place and select, or delete, "
                f"{', '.join(point_list.left_out_names[:5])}."
            )
    except InputError as error:
        raise InputError(f"The file {path} cannot be used: {error}") from None
    return point_list


def write_markups(
    path: str | os.PathLike[str], point_list: PointList, line_name: str | None = None
) -> None:
    """Write points in RAS mm as a markups file for Slicer, whole or not at all.

    `line_name` makes two points the ends of a line.
    """
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
    kind = {"type": "Fiducial"} if line_name is None else {"type": "Line", "name": line_name}
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
    if system not in ("LPS", "RAS"):
        raise InputError("its coordinate system must be LPS or RAS.")
    control_points = markup.get("controlPoints")
    if not isinstance(control_points, list) or not control_points:
        raise InputError("it holds no points.")
    labels, positions, left_out = [], [], {}
    for place, item in enumerate(control_points):
        label, position = _control_point(place + 1, item)
        if position is None:
            left_out[place] = label
        else:
            labels.append(label)
            positions.append(position)
    points = np.array(positions).reshape(-1, 3)
    return PointList(tuple(labels), points * LPS_TO_RAS if system == "LPS" else points, left_out)


def _control_point(number: int, item: Any) -> tuple[str, tuple[float, ...] | None]:
    """Return the label and the position of a point, None if it is not to be used."""
    if not isinstance(item, Mapping):
        raise InputError(f"point {number} must be an object.")
    label, status = item.get("label", ""), item.get("positionStatus", _PLACED)
    if not isinstance(label, str):
        raise InputError(f"the label of point {number} must be text.")
    if status not in _STATUSES:
        raise InputError(
            f"the positionStatus of point {number} must be one of {', '.join(_STATUSES)}."
        )
    if status != _PLACED or item.get("selected", True) is False:
        return label, None
    try:
        return label, numbers(3, COORDINATE_LIMIT_MM)(item.get("position"))
    except ValueError:
        raise InputError(
            f"the position of point {number} must be three numbers within ±1e6 mm."
        ) from None


_AXES = (("x", "y", "z"), ("r", "a", "s"), ("l", "p", "s"))


def read_points(path: str | os.PathLike[str]) -> PointList:
    """Return the points of a file in mm; a name in `.json` means markups, in `.ply` a point cloud.

    Points known to be in RAS or LPS are returned in RAS: from markups, Slicer's `.fcsv`, tables
        with columns r, a, s or l, p, s, and point clouds that say so. Columns x, y, z are taken as
    they are; the column `label` is optional. A point cloud has no labels.
    """
    name = os.fspath(path).lower()
    if name.endswith(".json"):
        return read_markups(path, allow_left_out=True)
    labels, points, left_out = (
        ((), read_point_cloud(path), {}) if name.endswith(".ply") else _from_csv(read_table(path))
    )
    try:
        return PointList(labels, points, left_out)
    except InputError as error:
        raise InputError(f"The file {path} cannot be used: {error}") from None


def _from_csv(table: CsvTable) -> tuple[tuple[str, ...], np.ndarray, dict[int, str]]:
    """Return labels and points, (n, 3) float, of a table, and the points left out."""
    axes = next((axes for axes in _AXES if {*axes} <= {*table.header}), _AXES[0])
    limit = COORDINATE_LIMIT_MM
    labels, points, left_out = [], [], {}
    for place, (line, cells) in enumerate(table.rows(axes, optional=("label",))):
        label = cells.get("label", "")
        # Slicer does not use points that are deselected or not placed.
        is_chosen = [cells.get(name, "1") != "0" for name in ("sel", "selected", "defined")]
        if not all(is_chosen) or cells.get(POSITION_STATUS, "") not in ("", "2"):
            left_out[place] = label
            continue
        labels.append(label)
        points.append([number_in(table.path, line, cells, axis, -limit, limit) for axis in axes])
    is_in_lps = axes == _AXES[2] or _frame(table) == "LPS"
    read = np.array(points).reshape(-1, 3)
    return tuple(labels), read * LPS_TO_RAS if is_in_lps else read, left_out


def _frame(table: CsvTable) -> str:
    """Return the frame that the first lines of Slicer's `.fcsv` name; empty without these."""
    # Slicer assumes LPS, too, where the line is missing.
    assumed = "LPS" if "markups fiducial file version" in table.remarks else "RAS"
    frame = table.remarks.get("coordinatesystem", assumed)
    frame = {"0": "RAS", "1": "LPS"}.get(frame, frame).upper()
    if frame not in ("RAS", "LPS"):
        raise InputError(
            f"The coordinate system of {table.path} must be LPS or RAS, not {frame[:20]!r}."
        )
    return frame


def read_point_numbers(
    path: str | os.PathLike[str], column: str, labels: Sequence[str], lowest: float, highest: float
) -> np.ndarray:
    """Return the numbers in a column for the points with these labels, (n,) float, in order.

    Rows are matched by the column `label`, or by order without one. Other columns are ignored, so
    the numbers may be in a file of points.
    """
    rows = read_table(path).rows((column,), optional=("label",))
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
