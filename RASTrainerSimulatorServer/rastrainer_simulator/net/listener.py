"""Listening on a port, with the address to ourselves."""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import socket
import ssl
from collections.abc import Callable


async def listen(
    make_protocol: Callable[[], asyncio.BaseProtocol],
    host: str,
    port: int,
    tls: ssl.SSLContext | None = None,
    handshake_s: float | None = None,
) -> list[asyncio.Server]:
    """Listen on each address of a host, encrypted with `tls`; `port` 0 is any free one.

    A peer may take `handshake_s` to agree on a key. Raises OSError or OverflowError if the address
    cannot be listened on.
    """
    loop = asyncio.get_running_loop()
    found = await loop.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    with contextlib.ExitStack() as opened:
        sockets = [
            opened.enter_context(listening_socket(family, address))
            for family, _kind, _protocol, _name, address in dict.fromkeys(found)
        ]
        opened.pop_all()
    timeout_s = None if tls is None else handshake_s
    return [
        await loop.create_server(
            make_protocol, sock=listening, ssl=tls, ssl_handshake_timeout=timeout_s
        )
        for listening in sockets
    ]


def listening_socket(family: int, address: tuple) -> socket.socket:
    """Return a socket that listens, with the address to itself."""
    # The protocol is named, since asyncio sets TCP_NODELAY by it.
    listening = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    try:
        listening.setblocking(False)
        # On Windows another program could otherwise take over a port in use. Elsewhere it could
        # not, and a port that was left a moment ago should be free.
        option = getattr(socket, "SO_EXCLUSIVEADDRUSE", socket.SO_REUSEADDR)
        listening.setsockopt(socket.SOL_SOCKET, option, 1)
        if family == socket.AF_INET6:
            listening.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        listening.bind(address)
        listening.listen()
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
