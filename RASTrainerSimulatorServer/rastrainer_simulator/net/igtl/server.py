"""The OpenIGTLink server: listens for clients, or itself connects to a Slicer that listens."""

from __future__ import annotations

import asyncio
import logging
from collections import Counter
from collections.abc import Collection
from typing import Protocol

from rastrainer.errors import InputError
from rastrainer.igtl.message import Message
from rastrainer_simulator.net.igtl.connection import ClientConnection
from rastrainer_simulator.net.limits import LinkLimits
from rastrainer_simulator.net.listener import Listener

_CONNECT_TIMEOUT_S = 5.0
_CLOSE_TIMEOUT_S = 0.5
_logger = logging.getLogger("rastrainer.igtl")

_PERIOD_S = 1.0
_MAX_KINDS = 20


class LinkHandler(Protocol):
    """Handles clients and their messages; called in the event loop's thread."""

    def connected(self, connection: ClientConnection) -> None:
        """Greet a client."""

    def received(self, connection: ClientConnection, message: Message) -> None:
        """Process one valid message."""

    def disconnected(self, connection: ClientConnection) -> None:
        """Forget a client."""


class IgtlServer:
    """Owns the connections of all clients; what one of them does disturbs no other.

    Attributes:
        limits: what one client may cost.
    """

    def __init__(self, handler: LinkHandler, limits: LinkLimits | None = None):
        self.limits = limits or LinkLimits()
        self._handler = handler
        self._log = LinkLog()
        self._connections: dict[ClientConnection, None] = {}
        self._opened: set[ClientConnection] = set()
        self._listener: Listener | None = None

    @property
    def clients(self) -> Collection[ClientConnection]:
        """The connections that may be sent to, at this moment."""
        return tuple(self._opened)

    @property
    def reading_share(self) -> float:
        return self.limits.reading_share / max(1, len(self._connections))

    async def listen(self, host: str, port: int) -> int:
        """Listen and return the port, which is any free one where `port` is 0."""
        listener = Listener(lambda: ClientConnection(self), self.limits.new_clients_per_s)
        try:
            found = await listener.listen(host, port)
        except OSError as error:
            reason = error.strerror or str(error)
            raise InputError(
                f"Cannot listen on {host}:{port} ({reason}); "
                "choose another port, or stop the program that uses it."
            ) from None
        self._listener = listener
        return found

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
                    self._log.note(f"Nothing listens at {host}:{port} yet.")
                    is_absence_logged = True
            await asyncio.sleep(self.limits.reconnect_s)

    async def close(self) -> None:
        """Stop listening, send the clients what is still waiting, and end."""
        if self._listener is not None:
            self._listener.close()
        connections = tuple(self._connections)
        for connection in connections:
            connection.finish()
        closed = [asyncio.create_task(connection.closed.wait()) for connection in connections]
        if closed:
            await asyncio.wait(closed, timeout=_CLOSE_TIMEOUT_S)
        for connection in connections:
            connection.drop()
        await asyncio.gather(*closed)
        self._log.close()

    def connected(self, connection: ClientConnection) -> None:
        """Accept a connection; if there are too many, the oldest silent one is dropped for it."""
        if len(self._connections) >= self.limits.clients:
            silent = next((each for each in self._connections if each.is_silent), None)
            if silent is None:
                connection.drop(f"There are {self.limits.clients} clients already.")
                return
            del self._connections[silent]
            silent.drop("It has sent nothing, and its place was needed.")
        self._connections[connection] = None

    def opened(self, connection: ClientConnection) -> None:
        """Hand on a connection that may be sent to."""
        self._opened.add(connection)
        self._handler.connected(connection)

    def received(self, connection: ClientConnection, message: Message) -> None:
        """Hand on one valid message."""
        self._handler.received(connection, message)

    def bad_bytes(self, connection: ClientConnection, errors: Counter) -> None:
        """Log what was no valid message."""
        for kind, times in errors.items():
            self._log.note(f"{connection.host}: {kind.value}", times)

    def disconnected(self, connection: ClientConnection, reason: str) -> None:
        """Forget a connection."""
        if reason:
            self._log.note(f"{connection.host} was disconnected: {reason}")
        self._connections.pop(connection, None)
        if connection in self._opened:
            self._opened.discard(connection)
            self._handler.disconnected(connection)


class LinkLog:
    """Logs the first problem immediately and those of the following second in one line."""

    def __init__(self):
        self._counts: Counter[str] = Counter()
        self._timer: asyncio.TimerHandle | None = None

    def note(self, what: str, times: int = 1) -> None:
        """Log `what`, now or with others within a second."""
        known = what in self._counts or len(self._counts) < _MAX_KINDS
        self._counts[what if known else "more of other kinds"] += times
        if self._timer is None:
            self._write_in_turn()

    def close(self) -> None:
        """Write the remaining lines."""
        if self._timer is not None:
            self._timer.cancel()
        self._write()

    def _write_in_turn(self) -> None:
        """Write, and again after a second if something new has come by then."""
        self._timer = None
        if self._counts:
            self._write()
            self._timer = asyncio.get_running_loop().call_later(_PERIOD_S, self._write_in_turn)

    def _write(self) -> None:
        if self._counts:
            parts = [f"{times} × {what}" for what, times in self._counts.items()]
            _logger.warning("%s", "; ".join(parts))
            self._counts.clear()
