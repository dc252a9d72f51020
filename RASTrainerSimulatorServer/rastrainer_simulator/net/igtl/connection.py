"""One client's connection: always reads, never waits, and ends alone when it misbehaves.

Outgoing messages are packed once for all clients, in a queue of limited size for each.
"""

from __future__ import annotations

import asyncio
import contextlib
import socket
import time
from collections import Counter, deque
from dataclasses import dataclass, replace
from typing import Protocol

from rastrainer.errors import InputError
from rastrainer.igtl.message import CONTENTS, Message, MessageReader, pack
from rastrainer_simulator.loop.timing import ReadingBudget
from rastrainer_simulator.net.limits import LinkLimits

_PIECE_BYTES = 16 * 1024


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
        """Whether more is waiting than one client may cost."""
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


class ConnectionOwner(Protocol):
    """Receives what happens on a connection; called in the event loop's thread."""

    limits: LinkLimits

    @property
    def reading_share(self) -> float:
        """Share of one core that reading from one connection may take."""

    def connected(self, connection: ClientConnection) -> None:
        """Accept a new connection, or drop it."""

    def opened(self, connection: ClientConnection) -> None:
        """Start sending to a connection whose header version is known."""

    def received(self, connection: ClientConnection, message: Message) -> None:
        """Process one valid message."""

    def bad_bytes(self, connection: ClientConnection, errors: Counter) -> None:
        """Count what was no valid message."""

    def disconnected(self, connection: ClientConnection, reason: str) -> None:
        """Forget a connection; `reason` is empty when the peer left."""


@dataclass
class _HalfMessage:
    """A message that has partly arrived.

    Attributes:
        number: of the messages before it; None while there is none.
        since: when its first bytes arrived, s.
        excused_s: time in which we did not read.
        received: bytes since then, including the first ones.
    """

    number: int | None = None
    since: float = 0.0
    excused_s: float = 0.0
    received: int = 0


class ClientConnection(asyncio.BufferedProtocol):
    """One peer.

    Messages go out with the header version that the peer speaks. A peer of version 1 could not
    even pass over one of version 2: so nothing is sent before the peer's first header, whatever
    follows it, or some tenths of a second in which a mere listener has sent none.

    Attributes:
        name: what the peer called itself, at first its address.
        scores: whether it has said that it registers and scores trials.
        offered: UUIDs of the trials that it was offered.
        host: the peer's, for the log.
        header_version: what the peer speaks.
        is_silent: it has not sent a single message.
        closed: set when the connection has ended.
    """

    def __init__(self, owner: ConnectionOwner):
        self.name = self.host = "a client"
        self.scores = False
        self.offered: set[str] = set()
        self.header_version = 2
        self.is_silent = True
        self.closed = asyncio.Event()
        self._owner = owner
        self._limits = owner.limits
        self._loop = asyncio.get_running_loop()
        self._transport: asyncio.Transport | None = None
        self._piece = bytearray(_PIECE_BYTES)
        self._reader = MessageReader(dict.fromkeys(CONTENTS, self._limits.message_bytes))
        self._budget = ReadingBudget(self._loop.time())
        self._queue = OutgoingQueue(self._limits.waiting_messages, self._limits.waiting_bytes)
        self._flush_is_due = False
        self._is_paused = False
        self._open_soon: asyncio.TimerHandle | None = None
        self._read_on: asyncio.TimerHandle | None = None
        self._drop_slow: asyncio.TimerHandle | None = None
        self._drop_stalled: asyncio.TimerHandle | None = None
        self._half = _HalfMessage()
        self._reason = ""

    def send(self, message: Outgoing) -> None:
        """Send what must not be lost, after all that was sent so before."""
        data = message.packed(self.header_version)
        if data is not None:
            self._queue.put(data)
            self._flush_soon()

    def send_latest(self, message: Outgoing) -> None:
        """Send a device's state, in place of an older one that still waits."""
        data = message.packed(self.header_version)
        if data is not None:
            self._queue.put_latest(message.key, data)
            self._flush_soon()

    def drop(self, reason: str = "") -> None:
        """End the connection immediately; without a reason nothing is logged."""
        if self._transport is not None:
            self._reason = self._reason or reason
            self._transport.abort()

    def finish(self) -> None:
        """End the connection once the peer has taken what still waits."""
        self._flush()
        if self._open_transport is not None:
            self._open_transport.close()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Set the socket up and report."""
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        transport.set_write_buffer_limits(high=self._limits.buffer_bytes)
        set_up_socket(transport.get_extra_info("socket"), self._limits)
        # A peer that has already gone has no address.
        address = transport.get_extra_info("peername") or (self.host,)
        self.name = self.host = address[0]
        self._open_soon = self._loop.call_later(self._limits.first_message_s, self._open)
        self._owner.connected(self)

    def get_buffer(self, sizehint: int) -> bytearray:  # noqa: ARG002
        """Return where the next bytes go; small, so that one flood does not hold up the others."""
        return self._piece

    def buffer_updated(self, nbytes: int) -> None:
        """Read what arrived, and continue immediately or after a pause."""
        begin = time.thread_time()
        self._read(nbytes)
        spent = time.thread_time() - begin
        pause = self._budget.charge(spent, self._owner.reading_share, self._loop.time())
        transport = self._open_transport
        if pause > 0.0 and transport is not None:
            transport.pause_reading()
            self._half.excused_s += pause
            self._read_on = self._loop.call_later(pause, transport.resume_reading)

    def _read(self, nbytes: int) -> None:
        messages = self._reader.feed(bytes(self._piece[:nbytes]))
        if self._reader.version is not None:
            self.header_version = self._reader.version
            self._open()
        for message in messages:
            self.is_silent = False
            self._owner.received(self, message)
        if self._reader.errors:
            self._owner.bad_bytes(self, self._reader.errors)
            self._reader.errors.clear()
        if self._reader.refusal:
            self.drop(self._reader.refusal)
        self._watch_half_message(nbytes)

    def pause_writing(self) -> None:
        """Give the peer some seconds to read on."""
        self._is_paused = True
        self._drop_slow = self._loop.call_later(
            self._limits.slow_client_s,
            self.drop,
            f"It has not read for {self._limits.slow_client_s:g} s.",
        )

    def resume_writing(self) -> None:
        """Send what waits."""
        self._is_paused = False
        if self._drop_slow is not None:
            self._drop_slow.cancel()
        self._flush_soon()

    def connection_lost(self, error: Exception | None) -> None:
        """Report, once."""
        for timer in (self._open_soon, self._read_on, self._drop_slow, self._drop_stalled):
            if timer is not None:
                timer.cancel()
        self._transport = None
        self.closed.set()
        self._owner.disconnected(self, self._reason or _words(error))

    @property
    def _open_transport(self) -> asyncio.Transport | None:
        is_open = self._transport is not None and not self._transport.is_closing()
        return self._transport if is_open else None

    def _open(self) -> None:
        if self._open_soon is not None:
            self._open_soon.cancel()
            self._open_soon = None
            self._owner.opened(self)

    def _flush_soon(self) -> None:
        if self._queue.is_overfull:
            self.drop("Too much waits for it: it does not read.")
        elif not self._flush_is_due and not self._is_paused:
            self._flush_is_due = True
            self._loop.call_soon(self._flush)

    def _flush(self) -> None:
        """Write all that gathered since the last round of the event loop in few pieces."""
        self._flush_is_due = False
        while self._queue and not self._is_paused and self._open_transport is not None:
            self._open_transport.write(self._queue.take(self._limits.buffer_bytes))

    def _watch_half_message(self, nbytes: int) -> None:
        """Check that a message that has partly arrived is completed."""
        number = None if self._reader.is_between_messages else self._reader.taken
        if number is not None and number == self._half.number:
            self._half.received += nbytes
            return
        if self._drop_stalled is not None:
            self._drop_stalled.cancel()
            self._drop_stalled = None
        self._half = _HalfMessage(number, self._loop.time(), received=nbytes)
        if number is not None:
            self._look_again()

    def _look_again(self) -> None:
        wait = self._limits.half_message_s
        self._drop_stalled = self._loop.call_later(wait, self._drop_if_stalled)

    def _drop_if_stalled(self) -> None:
        """Drop a peer whose message comes too slowly, such as a byte now and then."""
        waited = self._loop.time() - self._half.since - self._half.excused_s
        if self._half.received < waited * self._limits.slowest_bytes_per_s:
            self.drop("It left a message half sent.")
        else:
            self._look_again()


def _words(error: Exception | None) -> str:
    """Return why the operating system ended a connection; empty when the peer left."""
    return "" if error is None else getattr(error, "strerror", None) or str(error)


def set_up_socket(peer: socket.socket, limits: LinkLimits) -> None:
    """Queue little in the kernel, and notice a machine that has gone."""
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, limits.buffer_bytes)
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    probe_s = max(1, int(limits.silent_peer_s / 6))
    options = {
        "TCP_KEEPIDLE": probe_s * 3,
        "TCP_KEEPINTVL": probe_s,
        "TCP_KEEPCNT": 3,
        "TCP_USER_TIMEOUT": int(limits.silent_peer_s * 1000),
    }
    for name, value in options.items():
        # Not every system has every option; each helps, none is required.
        with contextlib.suppress(AttributeError, OSError):
            peer.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)
