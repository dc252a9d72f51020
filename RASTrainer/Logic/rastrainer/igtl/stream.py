"""From a stream of bytes, arriving in any pieces, to messages; hostile until proven good."""

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
"""Bytes of a body that are held in memory until it is whole; longer ones are passed over."""

MAX_GARBAGE_BYTES = 64 * 1024
"""Bytes in a row that belong to no message, after which the stream is given up."""

# What a header begins with; `read_header` looks closer.
_HEADER_START = re.compile(rb"\0[\1\2][A-Z]")


class StreamError(str, Enum):
    """Why bytes did not become a message."""

    CHECKSUM = "wrong checksum"
    TYPE = "unsupported type"
    SIZE = "too long to keep"
    CONTENT = "invalid content"
    GARBAGE = "bytes that are no message"


class MessageReader:
    """Cuts a stream of bytes into messages, and counts what is none.

    A message that cannot be used is passed over by the length its header claims; after bytes that
    are no header the reader looks for the next one. Memory stays below `largest_kept` and one
    piece, whatever arrives. A stream that does not begin with a header is given up at once: a page
    in somebody's browser can make it send an HTTP request to any port, with messages in its body.

    Attributes:
        taken: messages that were used up, and stretches of waste between them.
        errors: how often each kind of trouble came up.
        refusal: empty, or why nothing more is read: the sentence to close the connection with.
    """

    def __init__(self, kept: Mapping[str, int] | None = None):
        """Keep only the types in `kept`, each up to so many bytes; all that we know by default."""
        self._kept = dict.fromkeys(CONTENTS, MAX_KEPT_BYTES) if kept is None else dict(kept)
        self._buffer = bytearray()
        self._to_skip = 0
        self._garbage = 0
        self.taken = 0
        self.errors: Counter[StreamError] = Counter()
        self.refusal = ""

    @property
    def is_between_messages(self) -> bool:
        """Whether nothing of a message is still missing."""
        return not self._buffer and not self._to_skip

    def feed(self, data: bytes) -> list[Message]:
        """Return the messages that `data` completes, in their order."""
        if self.refusal:
            return []
        self._buffer += data
        messages: list[Message] = []
        while self._take_one(messages):
            self.taken += 1
        return messages

    def _take_one(self, messages: list[Message]) -> bool:
        """Use up one message or one stretch of waste; False where more bytes are needed."""
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
            self.refusal = "It does not begin with an OpenIGTLink message."
            return False
        if not self._garbage:
            self.errors[StreamError.GARBAGE] += 1
        start = _HEADER_START.search(self._buffer, 1)
        # The last two bytes may begin a header whose third has not arrived.
        waste = start.start() if start else len(self._buffer) - 2
        del self._buffer[:waste]
        self._garbage += waste
        if self._garbage > MAX_GARBAGE_BYTES:
            self.refusal = "Nothing that arrives is an OpenIGTLink message."
            return False
        return True
