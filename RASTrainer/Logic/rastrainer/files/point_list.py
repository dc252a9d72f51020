"""Points in mm: lists, labeled or not, how two are paired, and clouds as PLY."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.reading import read_bytes
from rastrainer.files.writing import write_bytes

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


LIMIT_BYTES = 64 * 2**20
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
    content = read_bytes(path, LIMIT_BYTES)
    head, mark, body = content.replace(b"\r\n", b"\n", 50).partition(b"end_header\n")
    try:
        lines = head.decode("ascii").splitlines()
        if not mark or lines[0] != "ply":
            raise ValueError
        form, count, columns = _described(lines[1:])
        points = _vertices(form, count, columns, body)
    except (ValueError, LookupError):
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
