"""Point clouds as PLY: written binary, read from binary (little-endian) and from text."""

from __future__ import annotations

import os

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.reading import read_bytes
from rastrainer.files.writing import write_bytes

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
