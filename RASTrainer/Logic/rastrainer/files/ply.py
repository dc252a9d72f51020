"""PLY files: their elements as columns of numbers; clouds of points are read and written.

Text and both binary forms are read, with any elements, properties and lists, in any order.
"""

from __future__ import annotations

import os
import re
import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.reading import read_bytes
from rastrainer.files.writing import write_bytes

LIMIT_BYTES = 64 * 2**20
MAX_ROWS = 4_000_000
LPS_TO_RAS = np.array([-1.0, -1.0, 1.0])

_HEADER_BYTES = 64 * 2**10
_HEADER = re.compile(rb"ply *(\r\n|\n|\r).*?\1end_header *\1", re.DOTALL)
_SPACE = re.compile(r"comment\b.*\bSPACE=(\w+)", re.IGNORECASE)
_BYTE_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_TYPES = {
    **dict.fromkeys(("char", "int8"), "b"),
    **dict.fromkeys(("uchar", "uint8"), "B"),
    **dict.fromkeys(("short", "int16"), "h"),
    **dict.fromkeys(("ushort", "uint16"), "H"),
    **dict.fromkeys(("int", "int32"), "i"),
    **dict.fromkeys(("uint", "uint32"), "I"),
    **dict.fromkeys(("float", "float32"), "f"),
    **dict.fromkeys(("double", "float64"), "d"),
}

Column = np.ndarray | list[np.ndarray]
"""The numbers of a property, (n,); (n, k) of lists that are all equally long."""


@dataclass(frozen=True)
class PlyFile:
    """The content of a PLY file: by the names of element and property, its column.

    `space` is the frame that a comment names, such as RAS or LPS; empty without one.
    """

    space: str
    elements: dict[str, dict[str, Column]]

    @property
    def vertices(self) -> np.ndarray:
        """(n, 3) float, in RAS if the file says that it is in LPS, otherwise as they are.

        Raise LookupError if there are none with x, y and z.
        """
        columns = self.elements["vertex"]
        points = np.stack([np.asarray(columns[axis], float) for axis in ("x", "y", "z")], axis=1)
        return points * LPS_TO_RAS if self.space == "LPS" else points


class _Property(NamedTuple):
    """A column of an element: types as in `struct`; `length` is empty unless it holds lists."""

    name: str
    type: str
    length: str = ""


class _Element(NamedTuple):
    name: str
    rows: int
    properties: list[_Property]


def read_ply(path: str | os.PathLike[str]) -> PlyFile:
    content = read_bytes(path, LIMIT_BYTES)
    header = _HEADER.match(content, 0, _HEADER_BYTES)
    try:
        if header is None:
            raise ValueError
        lines = header[0].decode("latin-1").splitlines()
        order, elements = _described(lines)
    except (ValueError, LookupError):
        raise InputError(
            f"The file {path} must be a PLY file, whose header describes its elements."
        ) from None
    crowded = next((each.name for each in elements if each.rows > MAX_ROWS), None)
    if crowded is not None:
        raise InputError(f"The file {path} has more than {MAX_ROWS} of its element {crowded}.")
    spaces = [match[1].upper() for match in map(_SPACE.match, lines) if match]
    try:
        body = content[header.end() :]
        columns = _columns(elements, body, order)
    except (ValueError, LookupError, OverflowError, struct.error):
        raise InputError(
            f"The PLY file {path} is cut short, damaged or has bytes left over: it does not hold "
            "what its header says."
        ) from None
    return PlyFile(spaces[0] if spaces else "", columns)


def _described(lines: list[str]) -> tuple[str, list[_Element]]:
    """Return the order of the bytes, empty for text, and the elements.

    Raise ValueError or LookupError if the header is not one.
    """
    orders, elements = [], []
    for words in (line.split() for line in lines):
        if words[:1] == ["format"]:
            orders.append(_BYTE_ORDERS[words[1]])
        elif words[:1] == ["element"]:
            elements.append(_Element(words[1], int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            length, type_, name = words[2:]
            elements[-1].properties.append(_Property(name, _TYPES[type_], _TYPES[length]))
        elif words[:1] == ["property"]:
            elements[-1].properties.append(_Property(words[2], _TYPES[words[1]]))
    (order,) = orders
    if len({each.name for each in elements}) < len(elements):
        raise ValueError
    for each in elements:
        has_odd_list = any(column.length in tuple("fd") for column in each.properties)
        if each.rows < 0 or (each.rows and not each.properties) or has_odd_list:
            raise ValueError
    return order, elements


def _columns(elements: list[_Element], body: bytes, order: str) -> dict[str, dict[str, Column]]:
    """Return the columns of all elements; `order` is empty for text."""
    words = [] if order else body.split()
    at = 0

    def take(type_: str, count: int) -> np.ndarray:
        nonlocal at
        start, at = at, at + count * (struct.calcsize(type_) if order else 1)
        if not start <= at <= len(body if order else words):
            raise ValueError
        if order:
            return np.frombuffer(body[start:at], order + type_)
        number = float if type_ in "fd" else int
        return np.array([number(word) for word in words[start:at]], type_)

    read: dict[str, dict[str, Column]] = {}
    for element in elements:
        table = _even_table(element, body, at, order) if order else None
        if table is None:
            read[element.name] = _uneven_columns(element, take)
        else:
            at += table.nbytes
            names = enumerate(each.name for each in element.properties)
            read[element.name] = {name: table[f"values{number}"] for number, name in names}
    if body[at:].strip() if order else words[at:]:
        raise ValueError
    return read


def _uneven_columns(element: _Element, take: Callable[[str, int], np.ndarray]) -> dict[str, Column]:
    columns: dict[str, Column] = {}
    cells: list[list[Any]] = [[] for _ in element.properties]
    for _ in range(element.rows):
        for each, values in zip(element.properties, cells, strict=True):
            taken = take(each.type, int(take(each.length, 1)[0]) if each.length else 1)
            values.append(taken if each.length else taken[0])
    for each, values in zip(element.properties, cells, strict=True):
        is_even = not each.length or len({len(value) for value in values}) == 1
        columns[each.name] = np.array(values, each.type) if is_even else values
    return columns


def _even_table(element: _Element, body: bytes, at: int, order: str) -> np.ndarray | None:
    """Return the rows as one structured array; None if lists of a property differ in length."""
    fields: list[tuple] = []
    lists: list[tuple[str, int]] = []
    end = at
    for number, column in enumerate(element.properties):
        shape: tuple[int, ...] = ()
        if column.length and element.rows:
            count = struct.unpack_from(order + column.length, body, end)[0]
            end += struct.calcsize(column.length)
            lists.append((f"length{number}", count))
            fields.append((f"length{number}", order + column.length))
            shape = (count,)
            if not 0 <= count <= len(body):
                raise ValueError
        fields.append((f"values{number}", order + column.type, shape))
        end += struct.calcsize(column.type) * int(np.prod(shape))
    size = (end - at) * element.rows
    if at + size > len(body):
        if lists:
            return None
        raise ValueError
    if not element.rows:
        return np.empty(0, fields)
    table = np.frombuffer(body, np.dtype(fields), element.rows, at)
    return table if all((table[name] == count).all() for name, count in lists) else None


def write_ply(
    path: str | os.PathLike[str],
    points: np.ndarray,
    frame: str,
    triangles: np.ndarray | None = None,
) -> None:
    """Write points (n, 3) and triangles (m, 3), if there are any, whole or not at all.

    A comment names their frame, by which Slicer places them. A mesh has 32-bit numbers.
    """
    is_mesh = triangles is not None
    kind = "float" if is_mesh else "double"
    lines = ["ply", "format binary_little_endian 1.0", f"comment SPACE={frame}"]
    lines += [*([] if is_mesh else ["comment mm"]), f"element vertex {len(points)}"]
    lines += [f"property {kind} {axis}" for axis in "xyz"]
    content = np.asarray(points, dtype="<f4" if is_mesh else "<f8").tobytes()
    if triangles is not None:
        lines += [f"element face {len(triangles)}", "property list uchar int vertex_indices"]
        faces = np.empty(len(triangles), [("count", "u1"), ("corners", "<i4", (3,))])
        faces["count"], faces["corners"] = 3, triangles
        content += faces.tobytes()
    write_bytes(path, "\n".join([*lines, "end_header", ""]).encode("ascii") + content)


def read_point_cloud(path: str | os.PathLike[str]) -> np.ndarray:
    """Return the vertices of a PLY file, (n, 3) float, in its own unit; see `PlyFile.vertices`."""
    content = read_ply(path)
    try:
        return content.vertices
    except (LookupError, ValueError):
        raise InputError(f"The PLY file {path} must have vertices with x, y and z.") from None
