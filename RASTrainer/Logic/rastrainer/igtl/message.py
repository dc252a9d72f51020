"""Messages with header, extended header, content and metadata: to bytes, and from untrusted bytes.

Only the types in `CONTENTS` can be sent. Slicer crashes on most types with an underscore in their
name, so the type is never an argument: it follows from the class of the content.
"""

from __future__ import annotations

import re
import struct
import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import TypeAlias

from rastrainer.errors import InputError
from rastrainer.igtl.content import (
    STATUS_KEY,
    Command,
    CommandReply,
    Points,
    Status,
    String,
    Transform,
    decode_text,
    encode_text,
    pack_name,
    unpack_name,
)

_POLYNOMIAL = 0x42F0E1EBA9EA3693
_MASK = 0xFFFFFFFFFFFFFFFF


_TABLE = list(range(0, 256 << 56, 1 << 56))
for _bit in range(8):
    _TABLE = [((v << 1) ^ (_POLYNOMIAL if v >> 63 else 0)) & _MASK for v in _TABLE]


def plain_crc64(data: bytes) -> int:
    """Return the CRC-64 of `data` in plain Python, about ten megabytes a second."""
    value = 0
    for byte in data:
        value = (value << 8 & _MASK) ^ _TABLE[value >> 56 ^ byte]
    return value


crc64: Callable[[bytes], int]
try:
    from fastcrc.crc64 import ecma_182 as crc64
except ImportError:  # Slicer's Python has no fastcrc, and no user should have to install it there.
    crc64 = plain_crc64


Content: TypeAlias = Transform | String | Points | Status | Command | CommandReply

CONTENTS: Mapping[str, type[Content]] = {
    kind.TYPE: kind for kind in (Transform, String, Points, Status, Command, CommandReply)
}
"""Every type that is sent or understood."""

MAX_BODY_BYTES = 16 * 2**20
"""Bytes; a message that claims more is refused."""

MAX_METADATA = 256
"""Entries in the metadata of one message."""

_HEADER = struct.Struct(">H12s20sIIQQ")
_EXTENDED = struct.Struct(">HHI4x")
"""Sizes of itself, of the index and of the entries of metadata; the number of the message, which
nobody uses."""
_COUNT = struct.Struct(">H")
_ENTRY = struct.Struct(">HHI")
_TYPE_FIELD = re.compile(rb"[A-Z][A-Z0-9_]{0,11}\0*")

HEADER_BYTES = _HEADER.size


@dataclass(frozen=True)
class Message:
    """One message.

    The device, 1 to 20 ASCII characters, is the name of the node in Slicer; the class of the
    content is the type. Metadata need version 2 of the header. The timestamp is in seconds since
    1970, None for the time of packing; Slicer sends 0.
    """

    device: str
    content: Content
    metadata: Mapping[str, str] = field(default_factory=dict)
    timestamp: float | None = None
    version: int = 2


@dataclass(frozen=True)
class Header:
    """The first 58 bytes of a message."""

    version: int
    type: str
    device: str
    timestamp: float
    body_size: int
    checksum: int


def pack(message: Message) -> bytes:
    if type(message.content) not in CONTENTS.values():
        known = ", ".join(CONTENTS)
        raise InputError(f"The content of a message must be one of {known}.")
    device = pack_name(message.device, 20, "The device name of a message")
    if not device:
        raise InputError("A message must name its device.")
    timestamp = time.time() if message.timestamp is None else message.timestamp
    if not 0 <= timestamp < 2**32:
        raise InputError("The time of a message must fit 32 bits.")
    body = _pack_body(message)
    if len(body) > MAX_BODY_BYTES:
        raise InputError(f"The body of a message must have at most {MAX_BODY_BYTES} bytes.")
    seconds = int(timestamp)
    fraction = int((timestamp - seconds) * 2**32)
    kind = message.content.TYPE.encode("ascii")
    header = _HEADER.pack(message.version, kind, device, seconds, fraction, len(body), crc64(body))
    return header + body


def _pack_body(message: Message) -> bytes:
    content = message.content.pack()
    if message.version == 1:
        if message.metadata or not content:
            raise InputError("Metadata and empty lists must be sent with header version 2.")
        return content
    if message.version != 2:
        raise InputError("The header version must be 1 or 2.")
    if type(message.content) is CommandReply and STATUS_KEY not in message.metadata:
        raise InputError("An answer must say in its metadata whether the command succeeded.")
    if not (content or message.metadata):
        raise InputError("An empty list must be sent with metadata.")
    if len(message.metadata) > MAX_METADATA:
        raise InputError(f"A message must have at most {MAX_METADATA} metadata entries.")
    index, entries = _COUNT.pack(len(message.metadata)), b""
    for key, value in message.metadata.items():
        key_bytes = pack_name(key, 255, "A metadata key")
        if not key_bytes:
            raise InputError("A metadata key must not be empty.")
        encoding, value_bytes = encode_text(value)
        index += _ENTRY.pack(len(key_bytes), encoding, len(value_bytes))
        entries += key_bytes + value_bytes
    extended = _EXTENDED.pack(_EXTENDED.size, len(index), len(entries))
    return extended + content + index + entries


def read_header(data: bytes | bytearray) -> Header | None:
    """Return the header in the first 58 bytes of `data`, or None if there is none."""
    version, kind, device, seconds, fraction, size, checksum = _HEADER.unpack_from(data)
    if version not in (1, 2) or not _TYPE_FIELD.fullmatch(kind):
        return None
    name = kind.rstrip(b"\0").decode("ascii")
    timestamp = seconds + fraction / 2**32
    return Header(version, name, unpack_name(device), timestamp, size, checksum)


def unpack(header: Header, body: bytes, keep_bytes: bool = False) -> Message:
    """Return the message of a header and its body, whose checksum is not checked.

    `keep_bytes` keeps invalid UTF-8, see `decode_text`.
    """
    kind = CONTENTS.get(header.type)
    if kind is None:
        raise InputError(f"The type of a message must be one of {', '.join(CONTENTS)}.")
    if header.version == 1:
        content = kind.unpack(body, keep_bytes)
        return Message(header.device, content, {}, header.timestamp, 1)
    if len(body) < _EXTENDED.size:
        raise InputError("A message of header version 2 must have an extended header.")
    extended_size, index_size, entries_size = _EXTENDED.unpack_from(body)
    content_end = len(body) - index_size - entries_size
    if extended_size < _EXTENDED.size or content_end < extended_size:
        raise InputError("The sizes in an extended header must fit the message.")
    index = body[content_end : content_end + index_size]
    metadata = _unpack_metadata(index, body[content_end + index_size :], keep_bytes)
    content = kind.unpack(body[extended_size:content_end], keep_bytes)
    return Message(header.device, content, metadata, header.timestamp, 2)


def _unpack_metadata(index: bytes, entries: bytes, keep_bytes: bool) -> dict[str, str]:
    if not index:
        return {}
    count = int.from_bytes(index[: _COUNT.size], "big")
    listed = index[_COUNT.size : _COUNT.size + count * _ENTRY.size]
    is_cut = len(index) < _COUNT.size or len(listed) < count * _ENTRY.size
    if is_cut or count > MAX_METADATA:
        raise InputError(f"A message must list at most {MAX_METADATA} whole metadata entries.")
    metadata, start = {}, 0
    for key_size, _encoding, value_size in _ENTRY.iter_unpack(listed):
        value_start, end = start + key_size, start + key_size + value_size
        if end > len(entries):
            raise InputError("The metadata of a message must be as long as they say.")
        key = decode_text(entries[start:value_start], keep_bytes)
        metadata[key] = decode_text(entries[value_start:end], keep_bytes)
        start = end
    return metadata


MAX_KEPT_BYTES = 2**20
"""Longer bodies are skipped instead of buffered."""

MAX_GARBAGE_BYTES = 64 * 1024
"""Bytes in a row that belong to no message, after which the stream is rejected."""

# The start of a header; `read_header` checks the rest.
_HEADER_START = re.compile(rb"\0[\1\2][A-Z]")


class StreamError(str, Enum):
    """Why bytes were not accepted as a message."""

    CHECKSUM = "wrong checksum"
    TYPE = "unsupported type"
    SIZE = "too long to keep"
    CONTENT = "invalid content"
    GARBAGE = "bytes that are no message"


class MessageReader:
    """Splits a stream of bytes into messages and counts errors.

    An unusable message is skipped by the length in its header; after bytes that are no header, the
    reader searches for the next header. Memory is limited. A stream that does not start with a
    header is rejected at once: a web page can make a browser send an HTTP request with messages in
    its body to any port.

    `taken` counts processed messages and stretches of garbage, `errors` each kind of error;
    `version` is the last header's, usable or not. `refusal` says why reading stopped.
    """

    def __init__(self, kept: Mapping[str, int] | None = None):
        """Keep only the types in `kept`, up to the given sizes; by default all known types."""
        self._kept = dict.fromkeys(CONTENTS, MAX_KEPT_BYTES) if kept is None else dict(kept)
        self._buffer = bytearray()
        self._to_skip = 0
        self._garbage = 0
        self.taken = 0
        self.version: int | None = None
        self.errors: Counter[StreamError] = Counter()
        self.refusal = ""

    @property
    def is_between_messages(self) -> bool:
        """Whether no message is incomplete."""
        return not self._buffer and not self._to_skip

    def feed(self, data: bytes) -> list[Message]:
        if self.refusal:
            return []
        self._buffer += data
        messages: list[Message] = []
        while self._take_one(messages):
            self.taken += 1
        return messages

    def _take_one(self, messages: list[Message]) -> bool:
        """Process one message or stretch of garbage; return False if more bytes are needed."""
        if self._to_skip:
            skipped = min(self._to_skip, len(self._buffer))
            del self._buffer[:skipped]
            self._to_skip -= skipped
            return not self._to_skip
        if len(self._buffer) < HEADER_BYTES:
            return False
        header = read_header(self._buffer)
        if header is None:
            return self._find_next_header()
        self.version = header.version
        if header.body_size > MAX_BODY_BYTES:
            self.refusal = f"A message claims more than {MAX_BODY_BYTES} bytes."
            return False
        wanted_bytes = self._kept.get(header.type)
        if wanted_bytes is None or header.body_size > wanted_bytes:
            self.errors[StreamError.TYPE if wanted_bytes is None else StreamError.SIZE] += 1
            self._to_skip = HEADER_BYTES + header.body_size
            return True
        end = HEADER_BYTES + header.body_size
        if len(self._buffer) < end:
            return False
        body = bytes(self._buffer[HEADER_BYTES:end])
        del self._buffer[:end]
        if crc64(body) != header.checksum:
            self.errors[StreamError.CHECKSUM] += 1
            return True
        self._garbage = 0
        try:
            messages.append(unpack(header, body))
        except InputError:
            self.errors[StreamError.CONTENT] += 1
        return True

    def _find_next_header(self) -> bool:
        if not self.taken:
            self.refusal = "It does not start with an OpenIGTLink message."
            return False
        if not self._garbage:
            self.errors[StreamError.GARBAGE] += 1
        start = _HEADER_START.search(self._buffer, 1)
        # The last two bytes may be the start of a header.
        waste = start.start() if start else len(self._buffer) - 2
        del self._buffer[:waste]
        self._garbage += waste
        if self._garbage > MAX_GARBAGE_BYTES:
            self.refusal = "Nothing that arrives is an OpenIGTLink message."
            return False
        return True
