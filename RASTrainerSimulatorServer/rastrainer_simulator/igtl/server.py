"""The OpenIGTLink server: listens for clients, or itself connects to a Slicer that listens."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Collection
from typing import Protocol

from rastrainer.errors import InputError
from rastrainer.igtl.message import Message
from rastrainer_simulator.igtl.connection import Connection
from rastrainer_simulator.igtl.limits import Limits
from rastrainer_simulator.igtl.link_log import LinkLog
from rastrainer_simulator.listener import Listener

_CONNECT_TIMEOUT_S = 5.0
_CLOSE_TIMEOUT_S = 0.5


class LinkHandler(Protocol):
    """What is done with clients and their messages; called in the event loop's thread."""

    def connected(self, connection: Connection) -> None:
        """Greet a client."""

    def received(self, connection: Connection, message: Message) -> None:
        """Take one valid message."""

    def disconnected(self, connection: Connection) -> None:
        """Forget a client."""


class IgtlServer:
    """Owns the connections of all clients; what one of them does disturbs no other.

    Attributes:
        limits: what one client may cost.
    """

    def __init__(self, handler: LinkHandler, limits: Limits | None = None):
        self.limits = limits or Limits()
        self._handler = handler
        self._log = LinkLog()
        self._connections: dict[Connection, None] = {}
        self._opened: set[Connection] = set()
        self._listener: Listener | None = None

    @property
    def clients(self) -> Collection[Connection]:
        """The connections that may be sent to, at this moment."""
        return tuple(self._opened)

    @property
    def reading_share(self) -> float:
        """Share of one core that reading from one connection may take."""
        return self.limits.reading_share / max(1, len(self._connections))

    async def listen(self, host: str, port: int) -> int:
        """Listen and return the port, which is any free one where `port` is 0.

        Raises:
            InputError: the address cannot be listened on.
        """
        listener = Listener(lambda: Connection(self), self.limits.new_clients_per_s)
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
        """Be the client of a Slicer that listens, and come back whenever it went; never returns."""
        loop = asyncio.get_running_loop()
        is_absence_told = False
        while True:
            attempt = loop.create_connection(lambda: Connection(self), host, port)
            try:
                _transport, connection = await asyncio.wait_for(attempt, _CONNECT_TIMEOUT_S)
                is_absence_told = False
                await connection.closed.wait()
            except (OSError, asyncio.TimeoutError):
                if not is_absence_told:
                    self._log.note(f"Nothing listens at {host}:{port} yet.")
                    is_absence_told = True
            await asyncio.sleep(self.limits.reconnect_s)

    async def close(self) -> None:
        """Stop listening, let the clients have what still waits for them, and end."""
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

    def connected(self, connection: Connection) -> None:
        """Accept a connection; where there are too many, the oldest silent one yields to it."""
        if len(self._connections) >= self.limits.clients:
            silent = next((each for each in self._connections if each.is_silent), None)
            if silent is None:
                connection.drop(f"There are {self.limits.clients} clients already.")
                return
            del self._connections[silent]
            silent.drop("It has said nothing, and its place was needed.")
        self._connections[connection] = None

    def opened(self, connection: Connection) -> None:
        """Hand on a connection that may be sent to."""
        self._opened.add(connection)
        self._handler.connected(connection)

    def received(self, connection: Connection, message: Message) -> None:
        """Hand on one valid message."""
        self._handler.received(connection, message)

    def bad_bytes(self, connection: Connection, errors: Counter) -> None:
        """Log what was no valid message."""
        for kind, times in errors.items():
            self._log.note(f"{connection.host}: {kind.value}", times)

    def disconnected(self, connection: Connection, reason: str) -> None:
        """Forget a connection."""
        if reason:
            self._log.note(f"{connection.host} was disconnected: {reason}")
        self._connections.pop(connection, None)
        if connection in self._opened:
            self._opened.discard(connection)
            self._handler.disconnected(connection)
