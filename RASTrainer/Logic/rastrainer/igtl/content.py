"""The contents of messages: names and texts, transform, status, points, command and its answer.

`pack` and `unpack` raise `InputError` for anything that the format does not allow. With
`keep_bytes`, invalid UTF-8 is kept as `decode_text` describes.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, TypeVar

from rastrainer.errors import InputError

ASCII = 3
UTF8 = 106
"""IANA numbers of the two encodings that are sent."""

_FLOAT32_MAX = 3.4028234663852886e38


def pack_name(name: str, size: int, what: str) -> bytes:
    """Return `name` as printable ASCII of at most `size` bytes; `struct` pads it."""
    if len(name) > size or not (name.isascii() and name.isprintable()):
        raise InputError(f"{what} must be printable ASCII of at most {size} characters.")
    return name.encode("ascii")


def unpack_name(field: bytes, keep_bytes: bool = False) -> str:
    """Return the text before the first NUL; non-ASCII characters are replaced.

    With `keep_bytes` it is decoded like `decode_text`.
    """
    name = field.partition(b"\0")[0]
    text = decode_text(name, True) if keep_bytes else name.decode("ascii", "replace")
    return text.rstrip()


def encode_text(text: str) -> tuple[int, bytes]:
    """Return the IANA number of the encoding and the bytes of `text`."""
    if "\0" in text:
        raise InputError("A text must not contain NUL characters.")
    if text.isascii():
        return ASCII, text.encode("ascii")
    try:
        return UTF8, text.encode("utf-8")
    except UnicodeEncodeError:
        raise InputError("A text must be valid Unicode.") from None


def decode_text(data: bytes, keep_bytes: bool = False) -> str:
    """Return UTF-8 text without the NULs that some peers append.

    The declared encoding is ignored: Slicer declares ASCII for UTF-8. With `keep_bytes`, invalid
    bytes become lone surrogates, from which they can be recovered.
    """
    try:
        return data.decode("utf-8", "surrogateescape" if keep_bytes else "strict").rstrip("\0")
    except UnicodeDecodeError:
        raise InputError("A text must be encoded in UTF-8.") from None


def check_float32(values: Sequence[float], what: str) -> None:
    for value in values:
        # NaN compares as false, too.
        if not -_FLOAT32_MAX <= value <= _FLOAT32_MAX:
            raise InputError(f"{what} must be finite 32-bit numbers.")


_TRANSFORM = struct.Struct(">12f")
_STRING = struct.Struct(">HH")
_STATUS = struct.Struct(">HQ20s")

MAX_STRING_BYTES = 65_535
"""Bytes that a STRING holds: its length is a 16-bit number."""


def _unpack_with_text(
    layout: struct.Struct, data: bytes, what: str, keep_bytes: bool
) -> tuple[Any, ...]:
    """Return the fields of a layout that ends with encoding and length of a text, and the text."""
    if len(data) < layout.size:
        raise InputError(f"A {what} must have at least {layout.size} bytes, not {len(data)}.")
    *fields, _encoding, length = layout.unpack_from(data)
    if length > len(data) - layout.size:
        raise InputError(f"A {what} must be as long as it says.")
    return *fields, decode_text(data[layout.size : layout.size + length], keep_bytes)


@dataclass(frozen=True)
class Transform:
    """A homogeneous transform in mm; becomes a linear transform node in Slicer.

    Its twelve numbers are the three columns of the rotation and then the translation.
    """

    TYPE: ClassVar[str] = "TRANSFORM"
    columns: tuple[float, ...]

    def __post_init__(self):
        if len(self.columns) != 12:
            raise InputError("A transform must have 12 numbers: three columns and a translation.")
        check_float32(self.columns, "The numbers of a transform")

    @property
    def matrix(self) -> tuple[tuple[float, ...], ...]:
        """The `(4, 4) float` matrix, row by row."""
        return (*(self.columns[row::3] for row in range(3)), (0.0, 0.0, 0.0, 1.0))

    def pack(self) -> bytes:
        return _TRANSFORM.pack(*self.columns)

    @classmethod
    def unpack(cls, data: bytes, keep_bytes: bool = False) -> Transform:  # noqa: ARG003
        if len(data) != _TRANSFORM.size:
            raise InputError(f"A TRANSFORM must have {_TRANSFORM.size} bytes, not {len(data)}.")
        return cls(_TRANSFORM.unpack(data))


@dataclass(frozen=True)
class String:
    """A text; becomes a text node in Slicer."""

    TYPE: ClassVar[str] = "STRING"
    text: str

    def pack(self) -> bytes:
        encoding, data = encode_text(self.text)
        if len(data) > MAX_STRING_BYTES:
            raise InputError(
                f"A STRING must have at most {MAX_STRING_BYTES} bytes, not {len(data)}."
            )
        return _STRING.pack(encoding, len(data)) + data

    @classmethod
    def unpack(cls, data: bytes, keep_bytes: bool = False) -> String:
        (text,) = _unpack_with_text(_STRING, data, cls.TYPE, keep_bytes)
        return cls(text)


@dataclass(frozen=True)
class Status:
    """The state of a device; becomes a status node in Slicer.

    Code 1 is OK, others are the protocol's error codes; the device defines the subcode; the name of
    the error has at most 20 ASCII characters.
    """

    TYPE: ClassVar[str] = "STATUS"
    OK: ClassVar[int] = 1
    code: int
    subcode: int = 0
    name: str = ""
    message: str = ""

    def pack(self) -> bytes:
        if not (0 <= self.code < 2**16 and 0 <= self.subcode < 2**64):
            raise InputError("A status must have a 16-bit code and a 64-bit subcode.")
        name = pack_name(self.name, 20, "The name in a status")
        _encoding, message = encode_text(self.message)
        return _STATUS.pack(self.code, self.subcode, name) + message + b"\0"

    @classmethod
    def unpack(cls, data: bytes, keep_bytes: bool = False) -> Status:
        if len(data) < _STATUS.size:
            raise InputError(f"A STATUS must have at least {_STATUS.size} bytes, not {len(data)}.")
        code, subcode, name = _STATUS.unpack_from(data)
        message = data[_STATUS.size :].partition(b"\0")[0]
        return cls(code, subcode, unpack_name(name), decode_text(message, keep_bytes))


_COMMAND = struct.Struct(">I128sHI")
_T = TypeVar("_T", bound="_NumberedText")


@dataclass(frozen=True)
class _NumberedText:
    """The common part of a command and its answer: the sender's 32-bit number and the name.

    The name has at most 128 ASCII characters; bodies, arguments or results, are JSON objects.
    """

    command_id: int
    name: str
    body: str = ""

    def pack(self) -> bytes:
        if not 0 <= self.command_id < 2**32:
            raise InputError("The number of a command must fit 32 bits.")
        name = pack_name(self.name, 128, "The name of a command")
        encoding, body = encode_text(self.body)
        return _COMMAND.pack(self.command_id, name, encoding, len(body)) + body

    @classmethod
    def unpack(cls: type[_T], data: bytes, keep_bytes: bool = False) -> _T:
        command_id, name, body = _unpack_with_text(_COMMAND, data, "COMMAND", keep_bytes)
        return cls(command_id, unpack_name(name, keep_bytes), body)


@dataclass(frozen=True)
class Command(_NumberedText):
    """A request; unlike other messages, Slicer queues every one of them."""

    TYPE: ClassVar[str] = "COMMAND"


@dataclass(frozen=True)
class CommandReply(_NumberedText):
    """The answer to the command of the same number and name; its metadata has the status."""

    TYPE: ClassVar[str] = "RTS_COMMAND"


STATUS_KEY = "Status"
ERROR_KEY = "ErrorMessage"
SUCCESS = "SUCCESS"
FAIL = "FAIL"
"""What an answer's metadata says, as Slicer reads it."""


_POINT = struct.Struct(">64s32x4B3f24x")

MAX_POINTS = 1_000


@dataclass(frozen=True)
class Point:
    """One labeled point; its group, diameter and owner are not sent, and not read.

    The label has at most 64 ASCII characters, the position is in mm, the color is RGBA from 0 to
    255; alpha 0 would hide the point in Slicer.
    """

    label: str
    position: tuple[float, float, float]
    color: tuple[int, int, int, int] = (255, 255, 0, 255)

    def __post_init__(self):
        if len(self.position) != 3:
            raise InputError("A point must have three coordinates.")
        check_float32(self.position, "The numbers of a point")
        if len(self.color) != 4 or not all(0 <= value <= 255 for value in self.color):
            raise InputError("A point's color must be four numbers from 0 to 255.")


@dataclass(frozen=True)
class Points:
    """A list of points; becomes a point list (markups fiducials) in Slicer."""

    TYPE: ClassVar[str] = "POINT"
    points: tuple[Point, ...]

    def pack(self) -> bytes:
        if len(self.points) > MAX_POINTS:
            raise InputError(f"A POINT message must have at most {MAX_POINTS} points.")
        what = "The label of a point"
        return b"".join(
            _POINT.pack(pack_name(each.label, 64, what), *each.color, *each.position)
            for each in self.points
        )

    @classmethod
    def unpack(cls, data: bytes, keep_bytes: bool = False) -> Points:
        if len(data) % _POINT.size:
            raise InputError(f"A POINT message must have {_POINT.size} bytes for each point.")
        fields = _POINT.iter_unpack(data)
        return cls(
            tuple(
                Point(unpack_name(label, keep_bytes), (x, y, z), tuple(color))
                for label, *color, x, y, z in fields
            )
        )
