"""From a stream of untrusted bytes, in pieces of any size, to messages."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from enum import Enum

from rastrainer.errors import InputError
from rastrainer.igtl.message import (
    CONTENTS,
    HEADER_BYTES,
    MAX_BODY_BYTES,
    Header,
    Message,
    read_header,
    unpack,
)
from rastrainer.igtl.wire import crc64

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

    Attributes:
        taken: number of processed messages and stretches of garbage between them.
        errors: number of errors of each kind.
        refusal: why reading stopped, the message to close the connection with; empty while reading.
    """

    def __init__(self, kept: Mapping[str, int] | None = None):
        """Keep only the types in `kept`, up to the given sizes; by default all known types."""
        self._kept = dict.fromkeys(CONTENTS, MAX_KEPT_BYTES) if kept is None else dict(kept)
        self._buffer = bytearray()
        self._to_skip = 0
        self._garbage = 0
        self.taken = 0
        self.errors: Counter[StreamError] = Counter()
        self.refusal = ""

    @property
    def is_between_messages(self) -> bool:
        """Whether no message is incomplete."""
        return not self._buffer and not self._to_skip

    def feed(self, data: bytes) -> list[Message]:
        """Return the messages that `data` completes, in order."""
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
            return self._skip()
        if len(self._buffer) < HEADER_BYTES:
            return False
        header = read_header(self._buffer)
        if header is None:
            return self._find_next_header()
        if header.body_size > MAX_BODY_BYTES:
            self.refusal = f"A message claims more than {MAX_BODY_BYTES} bytes."
            return False
        if self._is_unwanted(header):
            self._to_skip = HEADER_BYTES + header.body_size
            return True
        end = HEADER_BYTES + header.body_size
        if len(self._buffer) < end:
            return False
        body = bytes(self._buffer[HEADER_BYTES:end])
        del self._buffer[:end]
        self._read(header, body, messages)
        return True

    def _skip(self) -> bool:
        skipped = min(self._to_skip, len(self._buffer))
        del self._buffer[:skipped]
        self._to_skip -= skipped
        return not self._to_skip

    def _is_unwanted(self, header: Header) -> bool:
        if header.type not in self._kept:
            self.errors[StreamError.TYPE] += 1
            return True
        if header.body_size > self._kept[header.type]:
            self.errors[StreamError.SIZE] += 1
            return True
        return False

    def _read(self, header: Header, body: bytes, messages: list[Message]) -> None:
        if crc64(body) != header.checksum:
            self.errors[StreamError.CHECKSUM] += 1
            return
        self._garbage = 0
        try:
            messages.append(unpack(header, body))
        except InputError:
            self.errors[StreamError.CONTENT] += 1

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
