"""Points in mm: lists, labeled or not; in files: Slicer's markups (`.mrk.json`), CSV, and PLY."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.reading import number_in, read_bytes, read_json, read_rows
from rastrainer.files.writing import write_bytes, write_text
from rastrainer.json_checks import numbers

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


CLOUD_LIMIT_BYTES = 64 * 2**20
_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "<i2"),
    **dict.fromkeys(("ushort", "uint16"), "<u2"),
    **dict.fromkeys(("int", "int32"), "<i4"),
    **dict.fromkeys(("uint", "uint32"), "<u4"),
    **dict.fromkeys(("float", "float32"), "<f4"),
    **dict.fromkeys(("double", "float64"), "<f8"),
}


def write_point_cloud(path: str | os.PathLike[str], points: np.ndarray, frame: str) -> None:
    """Write points (n, 3) in mm as PLY, whole or not at all; a comment names their frame.

    Raises:
        InputError: the file cannot be written.
    """
    header = (
        f"ply\nformat binary_little_endian 1.0\ncomment SPACE={frame}\ncomment mm\n"
        f"element vertex {len(points)}\n"
        "property double x\nproperty double y\nproperty double z\nend_header\n"
    )
    write_bytes(path, header.encode("ascii") + np.asarray(points, dtype="<f8").tobytes())


def read_point_cloud(path: str | os.PathLike[str]) -> np.ndarray:
    """Return the vertices of a PLY file, (n, 3) float, in its own unit and frame.

    Raises:
        InputError: it cannot be read, is no such file, or is cut short.
    """
    content = read_bytes(path, CLOUD_LIMIT_BYTES)
    head, mark, body = content.replace(b"\r\n", b"\n", 50).partition(b"end_header\n")
    try:
        lines = head.decode("ascii").splitlines()
        if not mark or lines[0] != "ply":
            raise ValueError
        form, count, columns = _described(lines[1:])
        points = _vertices(form, count, columns, body)
    except (ValueError, LookupError, OverflowError):
        raise InputError(
            f"The file {path} must be a PLY file, as text or binary little-endian, whose first "
            "element is vertex with the numbers x, y and z."
        ) from None
    return points


def _described(lines: list[str]) -> tuple[str, int, dict[str, str]]:
    """Return format, number of vertices, and their columns; raise ValueError or LookupError."""
    form, count, columns = "", -1, {}
    for words in (line.split() for line in lines):
        if words[:1] == ["format"]:
            form = words[1]
        elif words[:1] == ["element"]:
            if count >= 0:
                break
            if words[1] != "vertex":
                raise ValueError
            count = int(words[2])
        elif words[:1] == ["property"]:
            columns[words[2]] = _TYPES[words[1]]
    if count < 1 or not {"x", "y", "z"} <= columns.keys():
        raise ValueError
    return form, count, columns


def _vertices(form: str, count: int, columns: dict[str, str], body: bytes) -> np.ndarray:
    if form == "binary_little_endian":
        table = np.frombuffer(body, np.dtype(list(columns.items())), count)
        return np.stack([table[axis].astype(float) for axis in ("x", "y", "z")], axis=1)
    if form != "ascii":
        raise ValueError
    rows = [line.split() for line in body.decode("ascii").splitlines()[:count]]
    if len(rows) < count:
        raise ValueError
    places = [list(columns).index(axis) for axis in ("x", "y", "z")]
    return np.array([[float(row[place]) for place in places] for row in rows])


MARKUPS_LIMIT_BYTES = 4 * 2**20
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
    document = read_json(path, MARKUPS_LIMIT_BYTES)
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
    name = os.fspath(path).lower()
    if name.endswith(".json"):
        return read_markups(path)
    labels, points = ((), read_point_cloud(path)) if name.endswith(".ply") else _from_csv(path)
    try:
        return PointList(labels, points)
    except InputError as error:
        raise InputError(f"The file {path} cannot be used: {error}") from None


def _from_csv(path: str | os.PathLike[str]) -> tuple[tuple[str, ...], np.ndarray]:
    rows = read_rows(path, ("x", "y", "z"), optional=("label",))
    limit = COORDINATE_LIMIT_MM
    points = [
        [number_in(path, line, cells, axis, -limit, limit) for axis in ("x", "y", "z")]
        for line, cells in rows
    ]
    return tuple(cells.get("label", "") for _, cells in rows), np.array(points)


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
