"""Listening on a port, with a limit on how many connections are taken in a second."""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import socket
import ssl
from collections.abc import Callable, Coroutine
from typing import Any

from rastrainer_simulator.loop.timing import AsyncRateLimiter

MAX_HANDSHAKES = 32
"""Most TLS handshakes at a time."""

_BACKLOG = 128
_NO_DESCRIPTORS_LEFT_S = 1.0


class Listener:
    """Takes connections at a bounded rate; the operating system keeps the others waiting.

    A peer that connects again and again is then slowed down, and not the control loop.
    """

    def __init__(
        self,
        make_protocol: Callable[[], asyncio.BaseProtocol],
        per_s: float,
        tls: ssl.SSLContext | None = None,
        handshake_s: float | None = None,
    ) -> None:
        """Make a listener, in the event loop's thread; nothing listens yet.

        Args:
            make_protocol: makes the protocol of a new connection.
            per_s: connections that are taken in a second.
            tls: the certificate, where the connections are encrypted, and
            handshake_s: how long a peer may take to agree on a key.
        """
        self._make_protocol = make_protocol
        self._rate_limiter = AsyncRateLimiter(per_s)
        self._tls = tls
        self._handshake_s = None if tls is None else handshake_s
        self._handshakes = asyncio.Semaphore(MAX_HANDSHAKES)
        self._tasks: set[asyncio.Task[None]] = set()

    async def listen(self, host: str, port: int) -> int:
        """Listen and return the port, which is any free one where `port` is 0.

        Raises:
            OSError, OverflowError: the address cannot be listened on.
        """
        loop = asyncio.get_running_loop()
        found = await loop.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
        with contextlib.ExitStack() as opened:
            sockets = [
                opened.enter_context(listening_socket(family, address))
                for family, _kind, _protocol, _name, address in dict.fromkeys(found)
            ]
            opened.pop_all()
        for listening in sockets:
            self._start(self._accept(listening))
        return sockets[0].getsockname()[1]

    def close(self) -> None:
        """Accept no more connections; existing ones remain."""
        for task in self._tasks:
            task.cancel()

    async def _accept(self, listening: socket.socket) -> None:
        loop = asyncio.get_running_loop()
        with listening:
            while True:
                await self._rate_limiter.passed()
                await self._handshakes.acquire()
                try:
                    peer, _address = await loop.sock_accept(listening)
                except OSError as error:
                    self._handshakes.release()
                    if not isinstance(error, ConnectionError):
                        # There are no descriptors left: some peer will go.
                        await asyncio.sleep(_NO_DESCRIPTORS_LEFT_S)
                    continue
                self._start(self._welcome(peer))

    async def _welcome(self, peer: socket.socket) -> None:
        loop = asyncio.get_running_loop()
        try:
            # Else a small message waits for 40 ms until the peer has acknowledged the one before.
            peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            await loop.connect_accepted_socket(
                self._make_protocol, peer, ssl=self._tls, ssl_handshake_timeout=self._handshake_s
            )
        except OSError:
            # It left, or could not agree on a key in time.
            peer.close()
        finally:
            self._handshakes.release()

    def _start(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)


def listening_socket(family: int, address: tuple) -> socket.socket:
    """Return a socket that listens, with the address to itself.

    Raises:
        OSError, OverflowError: the address cannot be listened on.
    """
    listening = socket.socket(family, socket.SOCK_STREAM)
    try:
        listening.setblocking(False)
        # On Windows another program could else take over the port of one that listens. Elsewhere
        # it could not, and a port that was left a moment ago should be free.
        option = getattr(socket, "SO_EXCLUSIVEADDRUSE", socket.SO_REUSEADDR)
        listening.setsockopt(socket.SOL_SOCKET, option, 1)
        if family == socket.AF_INET6:
            listening.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        listening.bind(address)
        listening.listen(_BACKLOG)
    except (OSError, OverflowError):
        listening.close()
        raise
    return listening


def is_loopback(host: str) -> bool:
    """Return whether a host is this computer's own address, which no other computer can use."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
