"""What waits to be sent: messages packed once for all clients, and one client's bounded queue."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

from rastrainer.errors import InputError
from rastrainer.igtl.message import Message, pack


class Outgoing:
    """A message, packed at most once for each header version however many clients it goes to."""

    def __init__(self, message: Message):
        self.key = (message.content.TYPE, message.device)
        self._message = message
        self._packed: dict[int, bytes | None] = {}

    def packed(self, version: int) -> bytes | None:
        """Return the message's bytes, or None where that header version cannot carry it.

        Version 1 has no metadata, and so no empty list: such a client keeps its last point.
        """
        if version not in self._packed:
            self._packed[version] = self._pack(version)
        return self._packed[version]

    def _pack(self, version: int) -> bytes | None:
        if version == self._message.version:
            return pack(self._message)
        try:
            return pack(replace(self._message, version=version, metadata={}))
        except InputError:
            return None


class OutgoingQueue:
    """First in, first out for commands and answers; for state only the latest of each device."""

    def __init__(self, most_messages: int, most_bytes: int):
        self._most_messages = most_messages
        self._most_bytes = most_bytes
        self._lasting: deque[bytes] = deque()
        self._bytes = 0
        self._latest: dict[tuple[str, str], bytes] = {}

    def __len__(self) -> int:
        return len(self._lasting) + len(self._latest)

    @property
    def is_overfull(self) -> bool:
        """Whether more waits than one client may cost."""
        return len(self) > self._most_messages or self._bytes > self._most_bytes

    def put(self, data: bytes) -> None:
        """Append what must not be lost."""
        self._lasting.append(data)
        self._bytes += len(data)

    def put_latest(self, key: tuple[str, str], data: bytes) -> None:
        """Replace what waits under the same key."""
        self._bytes += len(data) - len(self._latest.get(key, b""))
        self._latest[key] = data

    def take(self, about: int) -> bytes:
        """Remove and return messages of `about` bytes in all, the lasting ones first."""
        taken, size = [], 0
        while size < about and self._lasting:
            taken.append(self._lasting.popleft())
            size += len(taken[-1])
        while size < about and self._latest:
            taken.append(self._latest.pop(next(iter(self._latest))))
            size += len(taken[-1])
        self._bytes -= size
        return b"".join(taken)
