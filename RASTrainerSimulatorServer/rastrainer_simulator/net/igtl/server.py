"""The OpenIGTLink server: listens for clients, or itself connects to a Slicer that listens.

A connection always reads, never waits, and ends alone when it misbehaves.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
import time
from collections import Counter
from typing import Protocol

from rastrainer.errors import InputError
from rastrainer.igtl.message import CONTENTS, Message, MessageReader
from rastrainer_simulator.loop.timing import ReadingBudget
from rastrainer_simulator.net.igtl.outgoing import BUFFER_BYTES, Outgoing, OutgoingQueue
from rastrainer_simulator.net.limits import LinkLimits
from rastrainer_simulator.net.listener import listen

FIRST_MESSAGE_S = 0.25
"""Time in which a client shows its header version by its first message; then it counts as a
listener of version 2."""
MESSAGE_BYTES = 72 * 1024
"""Body of a message that is waited for; a longer one is passed over."""
HALF_MESSAGE_S = 10.0
"""After which a client is dropped that leaves a message half sent, or sends it too slowly."""
SILENT_PEER_S = 20.0
"""After which a peer is dropped whose machine does not answer any more."""
READING_SHARE = 0.3
"""Share of one core for reading; the connections divide it evenly."""
_PIECE_BYTES = 16 * 1024
WAITING_MESSAGES, WAITING_BYTES = 4096, 4 * 2**20
"""May wait for a client; another message drops it."""
RECONNECT_S = 1.0
"""Time between two attempts to reach a listening Slicer."""
_CONNECT_TIMEOUT_S = 5.0
_CLOSE_TIMEOUT_S = 0.5
_logger = logging.getLogger("rastrainer.igtl")

_PERIOD_S = 1.0
_MAX_KINDS = 20


class ClientConnection(asyncio.BufferedProtocol):
    """One peer; `scores` is whether it has said that it registers and scores trials.

    Messages go out with the header version that the peer speaks. A peer of version 1 could not
    even skip a message of version 2: so nothing is sent before the peer's first header, or some
    tenths of a second in which a mere listener has sent none.
    """

    def __init__(self, owner: IgtlServer):
        self.name = self.host = "a client"
        self.scores = False
        self.offered: set[str] = set()
        self.header_version = 2
        self.is_silent = True
        self.closed = asyncio.Event()
        self._owner = owner
        self._loop = asyncio.get_running_loop()
        self._transport: asyncio.Transport | None = None
        self._piece = bytearray(_PIECE_BYTES)
        self._reader = MessageReader(dict.fromkeys(CONTENTS, MESSAGE_BYTES))
        self._budget = ReadingBudget(self._loop.time())
        self._queue = OutgoingQueue()
        self._flush_is_due = False
        self._is_paused = False
        self._open_soon: asyncio.TimerHandle | None = None
        self._read_on: asyncio.TimerHandle | None = None
        self._drop_slow: asyncio.TimerHandle | None = None
        self._drop_stalled: asyncio.TimerHandle | None = None
        # How many messages came before a message that has partly arrived; None without one.
        self._half_message: int | None = None
        self._reason = ""

    def send(self, message: Outgoing) -> None:
        """Send what must not be lost, after all that was sent so before."""
        data = message.packed(self.header_version)
        if data is not None:
            self._queue.put(data)
            self._flush_soon()

    def send_latest(self, message: Outgoing) -> None:
        """Send a device's state, in place of an older state that still waits."""
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
        self._flush()
        if self._open_transport is not None:
            self._open_transport.close()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        transport.set_write_buffer_limits(high=BUFFER_BYTES)
        set_up_socket(transport.get_extra_info("socket"))
        # A peer that has already gone has no address.
        address = transport.get_extra_info("peername") or (self.host,)
        self.name = self.host = address[0]
        self._open_soon = self._loop.call_later(FIRST_MESSAGE_S, self._open)
        self._owner.connected(self)

    def get_buffer(self, sizehint: int) -> bytearray:  # noqa: ARG002
        """Return where the next bytes go; small, so that one flood does not hold up the others."""
        return self._piece

    def buffer_updated(self, nbytes: int) -> None:
        """Read what arrived, and continue immediately or after a pause."""
        begin = time.thread_time()
        self._read(nbytes)
        spent = time.thread_time() - begin
        share = READING_SHARE / max(1, len(self._owner.connections))
        pause = self._budget.charge(spent, share, self._loop.time())
        transport = self._open_transport
        if pause > 0.0 and transport is not None:
            transport.pause_reading()
            self._read_on = self._loop.call_later(pause, transport.resume_reading)

    def _read(self, nbytes: int) -> None:
        messages = self._reader.feed(bytes(self._piece[:nbytes]))
        if self._reader.version is not None:
            self.header_version = self._reader.version
            self._open()
        for message in messages:
            self.is_silent = False
            self._owner.handler.received(self, message)
        for kind, times in self._reader.errors.items():
            self._owner.log.note(f"{self.host}: {kind.value}", times)
        self._reader.errors.clear()
        if self._reader.refusal:
            self.drop(self._reader.refusal)
        number = None if self._reader.is_between_messages else self._reader.taken
        if number != self._half_message:
            self._half_message = number
            if self._drop_stalled is not None:
                self._drop_stalled.cancel()
            if number is not None:
                self._drop_stalled = self._loop.call_later(
                    HALF_MESSAGE_S, self.drop, "It left a message half sent."
                )

    def pause_writing(self) -> None:
        self._is_paused = True
        self._drop_slow = self._loop.call_later(
            self._owner.limits.slow_client_s,
            self.drop,
            f"It has not read for {self._owner.limits.slow_client_s:g} s.",
        )

    def resume_writing(self) -> None:
        self._is_paused = False
        if self._drop_slow is not None:
            self._drop_slow.cancel()
        self._flush_soon()

    def connection_lost(self, error: Exception | None) -> None:
        for timer in (self._open_soon, self._read_on, self._drop_slow, self._drop_stalled):
            if timer is not None:
                timer.cancel()
        self._transport = None
        self.closed.set()
        # Why the operating system ended the connection; no words if the peer left.
        words = "" if error is None else getattr(error, "strerror", None) or str(error)
        self._owner.disconnected(self, self._reason or words)

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
        if len(self._queue) > WAITING_MESSAGES or self._queue.bytes > WAITING_BYTES:
            self.drop("Too much waits for it: it does not read.")
        elif not self._flush_is_due and not self._is_paused:
            self._flush_is_due = True
            self._loop.call_soon(self._flush)

    def _flush(self) -> None:
        """Write all that gathered since the last round of the event loop in few pieces."""
        self._flush_is_due = False
        while self._queue and not self._is_paused and self._open_transport is not None:
            self._open_transport.write(self._queue.take(BUFFER_BYTES))


def set_up_socket(peer: socket.socket) -> None:
    """Queue little in the kernel, and notice a machine that has gone."""
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BUFFER_BYTES)
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    probe_s = max(1, int(SILENT_PEER_S / 6))
    options = {
        "TCP_KEEPIDLE": probe_s * 3,
        "TCP_KEEPINTVL": probe_s,
        "TCP_KEEPCNT": 3,
        "TCP_USER_TIMEOUT": int(SILENT_PEER_S * 1000),
    }
    for name, value in options.items():
        # Not every system has every option; each helps, none is required.
        with contextlib.suppress(AttributeError, OSError):
            peer.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)


class LinkHandler(Protocol):
    """Handles clients, once they may be sent to, and their messages; called by the event loop."""

    def connected(self, connection: ClientConnection) -> None: ...
    def received(self, connection: ClientConnection, message: Message) -> None: ...
    def disconnected(self, connection: ClientConnection) -> None: ...


class IgtlServer:
    """Owns the connections of all clients; what one of them does disturbs no other."""

    def __init__(self, handler: LinkHandler, limits: LinkLimits | None = None):
        self.limits = limits or LinkLimits()
        self.handler = handler
        self.log = LinkLog()
        self.connections: dict[ClientConnection, None] = {}
        self.clients: set[ClientConnection] = set()
        """The connections that may be sent to."""
        self._listening: list[asyncio.Server] = []

    async def listen(self, host: str, port: int) -> int:
        """Listen and return the port, which is any free one where `port` is 0."""
        try:
            self._listening = await listen(lambda: ClientConnection(self), host, port)
        except OSError as error:
            reason = error.strerror or str(error)
            raise InputError(
                f"Cannot listen on {host}:{port} ({reason}); "
                "choose another port, or stop the program that uses it."
            ) from None
        return self._listening[0].sockets[0].getsockname()[1]

    async def keep_connected_to(self, host: str, port: int) -> None:
        """Be the client of a listening Slicer, and reconnect whenever it is gone; never returns."""
        loop = asyncio.get_running_loop()
        is_absence_logged = False
        while True:
            attempt = loop.create_connection(lambda: ClientConnection(self), host, port)
            try:
                _transport, connection = await asyncio.wait_for(attempt, _CONNECT_TIMEOUT_S)
                is_absence_logged = False
                await connection.closed.wait()
            except (OSError, asyncio.TimeoutError):
                if not is_absence_logged:
                    self.log.note(f"Nothing listens at {host}:{port} yet.")
                    is_absence_logged = True
            await asyncio.sleep(RECONNECT_S)

    async def close(self) -> None:
        """Stop listening, send the waiting messages, and end."""
        for listening in self._listening:
            listening.close()
        connections = tuple(self.connections)
        for connection in connections:
            connection.finish()
        closed = [asyncio.create_task(connection.closed.wait()) for connection in connections]
        if closed:
            await asyncio.wait(closed, timeout=_CLOSE_TIMEOUT_S)
        for connection in connections:
            connection.drop()
        await asyncio.gather(*closed)
        self.log.close()

    def connected(self, connection: ClientConnection) -> None:
        """Accept a connection; if there are too many, the oldest silent one is dropped for it."""
        if len(self.connections) >= self.limits.clients:
            silent = next((each for each in self.connections if each.is_silent), None)
            if silent is None:
                connection.drop(f"There are {self.limits.clients} clients already.")
                return
            del self.connections[silent]
            silent.drop("It has sent nothing, and its place was needed.")
        self.connections[connection] = None

    def opened(self, connection: ClientConnection) -> None:
        self.clients.add(connection)
        self.handler.connected(connection)

    def disconnected(self, connection: ClientConnection, reason: str) -> None:
        if reason:
            self.log.note(f"{connection.host} was disconnected: {reason}")
        self.connections.pop(connection, None)
        if connection in self.clients:
            self.clients.discard(connection)
            self.handler.disconnected(connection)


class LinkLog:
    """Logs the first problem immediately and the problems of the next second in one line."""

    def __init__(self):
        self._counts: Counter[str] = Counter()
        self._timer: asyncio.TimerHandle | None = None

    def note(self, what: str, times: int = 1) -> None:
        """Log `what`, now or with others within a second."""
        known = what in self._counts or len(self._counts) < _MAX_KINDS
        self._counts[what if known else "more of other kinds"] += times
        if self._timer is None:
            self._write()

    def close(self) -> None:
        self._write()
        if self._timer is not None:
            self._timer.cancel()

    def _write(self) -> None:
        """Write now, and again after a second if something new has come by then."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if self._counts:
            parts = [f"{times} × {what}" for what, times in self._counts.items()]
            _logger.warning("%s", "; ".join(parts))
            self._counts.clear()
            self._timer = asyncio.get_running_loop().call_later(_PERIOD_S, self._write)
