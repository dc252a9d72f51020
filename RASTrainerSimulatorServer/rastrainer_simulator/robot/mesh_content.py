"""Mesh files that could unfold into far more than they hold, looked at before they are opened."""

from __future__ import annotations

import struct
from typing import Any

from rastrainer.errors import InputError
from rastrainer.finite_json import decode_finite_json
from rastrainer.plain_xml import plain_xml

MOST_NUMBERS = 20_000_000
"""Coordinates and corners of all shown copies together; half a million triangles have 3 million."""
MOST_COPIES = 1_000

_HEADER = struct.Struct("<4sII")
_CHUNK = struct.Struct("<II")
_PARTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


def checked_content(data: bytes, kind: str, what: str) -> bytes:
    """Return a mesh file's bytes as they may be given to a parser.

    `kind` is the suffix of its name, `what` begins the sentence of an error.

    Raises:
        InputError: a Collada file that is no plain XML or shows its parts too often, or a GLB file
            that claims more numbers than a mesh may have.
    """
    if kind == "dae":
        text = plain_xml(data, what)
        if len(text) * text.count("<instance_") > MOST_NUMBERS * MOST_COPIES:
            raise _too_much(what)
        return text.encode()
    if kind == "glb":
        _check_glb(data, what)
    return data


def _check_glb(data: bytes, what: str) -> None:
    try:
        magic, version, _size = _HEADER.unpack_from(data)
        size, _kind = _CHUNK.unpack_from(data, _HEADER.size)
        begin = _HEADER.size + _CHUNK.size
        tree = decode_finite_json(data[begin : begin + size].decode("utf-8"))
        if (magic, version) != (b"glTF", 2):
            raise ValueError
        numbers = _numbers_shown(tree)
    except (ValueError, TypeError, KeyError, IndexError, AttributeError, struct.error):
        raise InputError(f"{what} is not a GLB file (glTF 2.0).") from None
    if numbers > MOST_NUMBERS:
        raise _too_much(what)


def _numbers_shown(tree: Any) -> int:
    """Return of how many numbers the meshes of all nodes are made, or more."""
    counts = [whole(accessor["count"]) * _PARTS[accessor["type"]] for accessor in tree["accessors"]]
    meshes = [
        sum(
            counts[index]
            for primitive in mesh["primitives"]
            for index in (*primitive["attributes"].values(), primitive.get("indices", 0))
        )
        for mesh in tree["meshes"]
    ]
    nodes = tree.get("nodes", [])
    parents: dict[int, int] = {}
    for node in nodes:
        for child in node.get("children", ()):
            parents[child] = parents.get(child, 0) + 1
    if len(nodes) > MOST_COPIES or any(count > 1 for count in parents.values()):
        raise ValueError  # Where a node has two parents, it is no tree.
    shown = sum(meshes[node["mesh"]] for node in nodes if "mesh" in node)
    return max(shown, sum(counts))


def whole(value: Any) -> int:
    """Return a count; raise ValueError for what is none."""
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise ValueError
    return value


def _too_much(what: str) -> InputError:
    return InputError(f"{what} unfolds into more than {MOST_NUMBERS} numbers.")
