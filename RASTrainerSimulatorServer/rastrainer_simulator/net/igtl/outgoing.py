"""Messages on their way to clients: packed once for all, in a queue of limited size for each."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

from rastrainer.errors import InputError
from rastrainer.igtl.message import Message, pack

BUFFER_BYTES = 64 * 1024
"""Passed to the operating system ahead of a client that reads slowly."""


class Outgoing:
    """A message, packed at most once for each header version however many clients it goes to."""

    def __init__(self, message: Message):
        self.key = (message.content.TYPE, message.device)
        self._message = message
        self._packed: dict[int, bytes | None] = {}

    def packed(self, version: int) -> bytes | None:
        """Return the message's bytes, or None if that header version cannot carry it.

        Version 1 has no metadata, and so no empty list: such a client keeps its last point.
        """
        if version not in self._packed:
            message = self._message
            if version != message.version:
                message = replace(message, version=version, metadata={})
            try:
                self._packed[version] = pack(message)
            except InputError:
                if version == self._message.version:
                    raise
                self._packed[version] = None
        return self._packed[version]


class OutgoingQueue:
    """First in, first out for commands and answers; for state only the latest of each device."""

    def __init__(self) -> None:
        self._lasting: deque[bytes] = deque()
        self.bytes = 0
        self._latest: dict[tuple[str, str], bytes] = {}

    def __len__(self) -> int:
        return len(self._lasting) + len(self._latest)

    def put(self, data: bytes) -> None:
        """Append what must not be lost."""
        self._lasting.append(data)
        self.bytes += len(data)

    def put_latest(self, key: tuple[str, str], data: bytes) -> None:
        self.bytes += len(data) - len(self._latest.get(key, b""))
        self._latest[key] = data

    def take(self, about: int) -> bytes:
        """Remove and return messages of `about` bytes in all, lasting messages first."""
        taken, size = [], 0
        while size < about and self._lasting:
            taken.append(self._lasting.popleft())
            size += len(taken[-1])
        while size < about and self._latest:
            taken.append(self._latest.pop(next(iter(self._latest))))
            size += len(taken[-1])
        self.bytes -= size
        return b"".join(taken)
