"""Checks the bytes sent to 3D Slicer, without the code that sends them.

The rules are measured: see "Sent to Slicer" in SECURITY.md.
"""

import struct
from collections import Counter

SENT_TYPES = {b"TRANSFORM", b"STRING", b"POINT", b"STATUS", b"COMMAND", b"RTS_COMMAND"}
"""Slicer crashes on prefixed types such as GET_STATUS; of these it understands only RTS_COMMAND."""
LARGEST_BODY = 16 * 2**20
HEADER = struct.Struct(">H12s20sIIQQ")
EXTENDED = struct.Struct(">HHII")
POINT_BYTES = 136


class OffenseError(AssertionError):
    """Something was sent that would harm Slicer."""


class WireChecker:
    """Reads a stream of sent bytes, in any pieces, and raises `OffenseError` at forbidden messages.

    `seen` says how many messages of each type have passed, `names` names their devices.
    """

    def __init__(self) -> None:
        self._buffer = b""
        self.seen: Counter[bytes] = Counter()
        self.names: set[bytes] = set()

    def feed(self, data: bytes) -> None:
        self._buffer += data
        while len(self._buffer) >= HEADER.size:
            version, kind, device, _seconds, _fraction, size, checksum = HEADER.unpack_from(
                self._buffer
            )
            check_header(version, kind, device, size)
            if len(self._buffer) < HEADER.size + size:
                return
            body = self._buffer[HEADER.size : HEADER.size + size]
            self._buffer = self._buffer[HEADER.size + size :]
            check_body(version, kind.rstrip(b"\0"), body, checksum)
            name = kind.rstrip(b"\0")
            self.seen[name] += 1
            self.names.add(device.rstrip(b"\0"))


def check_header(version: int, kind: bytes, device: bytes, size: int) -> None:
    """Raise `OffenseError` where a header would harm."""
    _must(version in (1, 2), f"header version {version}")
    _must(kind.rstrip(b"\0") in SENT_TYPES, f"type {kind!r} crashes or is ignored with an error")
    name = device.rstrip(b"\0")
    _must(bool(name) and b"\0" not in name, f"device name {device!r}")
    _must(all(32 <= byte < 127 for byte in name), f"device name {device!r} is not ASCII")
    _must(0 < size <= LARGEST_BODY, f"body of {size} bytes: none stalls, 2 GiB crash the reader")


def check_body(version: int, kind: bytes, body: bytes, checksum: int) -> None:
    """Raise `OffenseError` where a body would harm."""
    _must(_crc64(body) == checksum, "wrong checksum: an empty node would be made")
    content, metadata = body, {}
    if version == 2:
        content, metadata = _opened(body)
    if kind == b"TRANSFORM":
        _must(len(content) == 48, "a transform of another length")
        _must_be_finite(struct.unpack(">12f", content))
    elif kind == b"POINT":
        _must(len(content) % POINT_BYTES == 0, "points of another length")
        _must(bool(content) or bool(metadata), "an empty list that Slicer would not clear")
        for start in range(0, len(content), POINT_BYTES):
            _must_be_finite(struct.unpack_from(">4f", content, start + 100))
    elif kind == b"STRING":
        length = struct.unpack_from(">H", content, 2)[0]
        _must(len(content) == 4 + length, "a text of another length")
        _must(b"\0" not in content[4:], "a text that Slicer cuts")
    elif kind == b"STATUS":
        _must(len(content) >= 31 and content.endswith(b"\0"), "a status without its end")
    else:
        length = struct.unpack_from(">I", content, 134)[0]
        _must(len(content) == 138 + length, "a command of another length")
        _must(b"\0" not in content[138:], "a command that Slicer cuts")
        if kind == b"RTS_COMMAND" and version == 2:
            _must(b"Status" in metadata, "an answer that Slicer cannot tell from a failure")


def _opened(body: bytes) -> tuple[bytes, dict[bytes, bytes]]:
    """Return the content and the metadata of a body of header version 2."""
    _must(len(body) >= EXTENDED.size, "an extended header that is cut")
    size, index_size, entries_size, _number = EXTENDED.unpack_from(body)
    end = len(body) - index_size - entries_size
    _must(size == EXTENDED.size and size <= end, "an extended header that does not fit")
    index, entries = body[end : end + index_size], body[end + index_size :]
    if not index:
        return body[size:end], {}
    (count,) = struct.unpack_from(">H", index)
    _must(len(index) == 2 + 8 * count, "an index of metadata of another length")
    metadata, start = {}, 0
    for number in range(count):
        key_size, _encoding, value_size = struct.unpack_from(">HHI", index, 2 + 8 * number)
        key = entries[start : start + key_size]
        _must(bool(key), "a metadata key without a letter")
        metadata[key] = entries[start + key_size : start + key_size + value_size]
        start += key_size + value_size
    _must(start == len(entries), "metadata of another length")
    return body[size:end], metadata


def _rest(value: int) -> int:
    """Divide one byte by the polynomial of ECMA-182, bit by bit as the standard has it."""
    value <<= 56
    for _ in range(8):
        value = (value << 1) ^ (0x142F0E1EBA9EA3693 if value >> 63 else 0)
    return value


RESTS = [_rest(value) for value in range(256)]


def _crc64(data: bytes) -> int:
    value = 0
    for byte in data:
        value = (value << 8 & 0xFFFFFFFFFFFFFFFF) ^ RESTS[value >> 56 ^ byte]
    return value


def _must_be_finite(numbers: tuple[float, ...]) -> None:
    _must(all(abs(number) <= 3.5e38 for number in numbers), "a number that is not finite")


def _must(is_right: bool, what: str) -> None:
    if not is_right:
        raise OffenseError(f"It was sent: {what}")
