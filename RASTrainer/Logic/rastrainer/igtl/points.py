"""The content POINT: a list of points, which replaces the list shown in Slicer."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import ClassVar

from rastrainer.errors import InputError
from rastrainer.igtl.wire import check_float32, pack_name, unpack_name

_POINT = struct.Struct(">64s32s4B4f20s")

MAX_POINTS = 1_000


@dataclass(frozen=True)
class Point:
    """One labeled point.

    Attributes:
        label: shown beside the point, at most 64 ASCII characters.
        position: `(3,) float`, mm.
        color: red, green, blue and alpha from 0 to 255; alpha 0 would hide the point in Slicer.
        group: `Unselected` makes Slicer show it as not selected.
        diameter: mm; Slicer drops it.
        owner: device the point belongs to; Slicer drops it.
    """

    label: str
    position: tuple[float, float, float]
    color: tuple[int, int, int, int] = (255, 255, 0, 255)
    group: str = ""
    diameter: float = 0.0
    owner: str = ""

    def __post_init__(self):
        if len(self.position) != 3:
            raise InputError("A point must have three coordinates.")
        check_float32((*self.position, self.diameter), "The numbers of a point")
        if len(self.color) != 4 or not all(0 <= value <= 255 for value in self.color):
            raise InputError("A point's color must be four numbers from 0 to 255.")


@dataclass(frozen=True)
class Points:
    """A list of points; becomes a point list (markups fiducials) in Slicer."""

    TYPE: ClassVar[str] = "POINT"
    points: tuple[Point, ...]

    def pack(self) -> bytes:
        """Return the content's bytes, 136 per point."""
        if len(self.points) > MAX_POINTS:
            raise InputError(f"A POINT message must have at most {MAX_POINTS} points.")
        return b"".join(_pack_point(point) for point in self.points)

    @classmethod
    def unpack(cls, data: bytes, keep_bytes: bool = False) -> Points:
        """Return the content of `data`."""
        if len(data) % _POINT.size:
            raise InputError(f"A POINT message must have {_POINT.size} bytes for each point.")
        points = (_unpack_point(fields, keep_bytes) for fields in _POINT.iter_unpack(data))
        return cls(tuple(points))


def _pack_point(point: Point) -> bytes:
    return _POINT.pack(
        pack_name(point.label, 64, "The label of a point"),
        pack_name(point.group, 32, "The group of a point"),
        *point.color,
        *point.position,
        point.diameter,
        pack_name(point.owner, 20, "The owner of a point"),
    )


def _unpack_point(fields: tuple, keep_bytes: bool) -> Point:
    label, group, red, green, blue, alpha, x, y, z, diameter, owner = fields
    return Point(
        label=unpack_name(label, keep_bytes),
        position=(x, y, z),
        color=(red, green, blue, alpha),
        group=unpack_name(group),
        diameter=diameter,
        owner=unpack_name(owner),
    )
