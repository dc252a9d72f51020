"""The HTTP server of views and of a board: only paired clients pass, but to page and pairing."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
import ssl
from collections.abc import Sequence
from pathlib import Path

from aiohttp import hdrs, web
from aiohttp.http_exceptions import HttpProcessingError
from aiohttp.typedefs import Handler

from rastrainer.errors import InputError
from rastrainer_simulator.assets import NOT_BUILT
from rastrainer_simulator.net.listener import listen
from rastrainer_simulator.net.views.access_control import (
    BEARER,
    COOKIE,
    PAIR_FIRST,
    ROLE,
    TOO_MANY,
    WRONG,
    PairingCode,
    Sessions,
    add_security_headers,
    check_origin,
    fresh_json,
    is_public,
    read_body,
    refuse_for,
)
from rastrainer_simulator.presentation.messages import PairingRequest, ViewRole

MAX_CONNECTIONS = 128
HANDSHAKE_S = 5.0
SHUTDOWN_S = 1.0
LARGEST_BODY = 1024
WATCHING_ROLES = [role for role in ViewRole if role is not ViewRole.VIEW]

_http_log = logging.getLogger(f"{__name__}.http")
# Only our own errors are logged, and not what strangers send.
_http_log.addFilter(
    lambda record: not (record.exc_info and isinstance(record.exc_info[1], HttpProcessingError))
)


class GuardedServer:
    """Serves clients with a session's key, on any number of ports.

    If all connections are in use, a new one replaces the oldest that has shown no key, or else the
    oldest that only watches: idle strangers keep nobody out, and spectators keep no participant
    out.
    """

    def __init__(
        self,
        sessions: Sessions,
        code: PairingCode,
        routes: Sequence[web.RouteDef],
        page: Path | None,
    ) -> None:
        """Make a server; `page` is the folder of the built page, whose files are public."""
        self._sessions = sessions
        self._code = code
        self._roles: dict[asyncio.BaseProtocol, ViewRole] = {}
        self._sent_away: set[asyncio.BaseProtocol] = set()
        app = web.Application(middlewares=[self._check], client_max_size=LARGEST_BODY)
        app.on_response_prepare.append(add_security_headers)
        app.add_routes([web.post("/pair", self._pair), *routes])
        if page is not None:
            app.add_routes([web.static("/", page)])
        self._runner = web.AppRunner(
            app, access_log=None, logger=_http_log, shutdown_timeout=SHUTDOWN_S
        )
        self._listening: list[asyncio.Server] = []

    async def listen(
        self, host: str, port: int, tls: ssl.SSLContext | None = None, or_any: bool = False
    ) -> int:
        """Listen, by TLS where there is a certificate, and return on which port.

        0 is any free one, as is another port that is taken with `or_any`.
        """
        if self._runner.server is None:
            await self._runner.setup()
        try:
            servers = await listen(self._protocol, host, port, tls, HANDSHAKE_S)
        except (OSError, OverflowError) as error:
            if or_any:
                return await self.listen(host, 0, tls)
            raise InputError(f"Cannot listen on {host}:{port}: {error}.") from None
        self._listening += servers
        return servers[0].sockets[0].getsockname()[1]

    def stop_listening(self) -> None:
        for server in self._listening:
            server.close()

    async def close(self) -> None:
        await self._runner.cleanup()

    def _protocol(self) -> asyncio.BaseProtocol:
        """Return the protocol of a new connection, for which another one may have to end."""
        server = self._runner.server
        assert server is not None, "it listens"
        self._sent_away.intersection_update(server.connections)
        there = [each for each in server.connections if each not in self._sent_away]
        self._roles = {each: self._roles[each] for each in there if each in self._roles}
        if len(there) >= MAX_CONNECTIONS:
            strangers = [each for each in there if each not in self._roles]
            watching = [each for each in there if self._roles.get(each) in WATCHING_ROLES]
            if not strangers and not watching:
                return _Refused()
            oldest = next(iter((*strangers, *watching)))
            self._sent_away.add(oldest)
            if oldest.transport is not None:
                # Closed, it would wait for its peer to read; so the pending write fails.
                with contextlib.suppress(OSError):
                    oldest.transport.get_extra_info("socket").shutdown(socket.SHUT_RDWR)
        return server()

    @web.middleware
    async def _check(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        check_origin(request)
        key = request.headers.get(hdrs.AUTHORIZATION, "")
        is_bearer = key.startswith(BEARER)
        key = key.removeprefix(BEARER) if is_bearer else request.cookies.get(COOKIE, "")
        role = self._sessions.role(key)
        if role is not None:
            request[ROLE] = role
            self._roles[request.protocol] = role
        elif not is_public(request):
            raise web.HTTPUnauthorized(text=PAIR_FIRST)
        return await handler(request)

    async def _pair(self, request: web.Request) -> web.Response:
        """Give a key, and a cookie with it, for the pairing code; a spectator's only watches."""
        asked = await read_body(request, PairingRequest)
        refuse_for(self._code.seconds_to_wait(), TOO_MANY)
        if not self._code.accepts(asked.code):
            # The one who caused a pause is sent the new code.
            refuse_for(self._code.seconds_to_wait(), TOO_MANY)
            raise web.HTTPForbidden(text=WRONG)
        key = self._sessions.open(asked.role)
        response = fresh_json({"key": key})
        response.set_cookie(
            COOKIE, key, path="/", httponly=True, samesite="Strict", secure=request.secure
        )
        return response


class _Refused(asyncio.Protocol):
    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        transport.close()


def page_answer(page: Path | None, name: str) -> web.StreamResponse:
    if page is None:
        return web.Response(text=NOT_BUILT, content_type="text/html")
    return web.FileResponse(page / name)
