"""Listen for HTTP within limits of connections, requests and sizes; behind a gate or not."""

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
from aiohttp.typedefs import Handler, Middleware

from rastrainer.errors import InputError
from rastrainer_simulator.assets import NOT_BUILT
from rastrainer_simulator.loop.timing import AsyncRateLimiter
from rastrainer_simulator.net.limits import ViewLimits
from rastrainer_simulator.net.listener import Listener
from rastrainer_simulator.net.views.access_control import (
    COOKIE,
    PAIR_FIRST,
    ROLE,
    TOO_MANY,
    WRONG,
    PairingCode,
    Sessions,
    add_security_headers,
    check_origin,
    is_public,
    read_body,
    refuse_for,
    session_key,
)
from rastrainer_simulator.presentation.messages import PairingRequest, ViewRole

REQUESTS_PER_S = 200.0
NEW_CONNECTIONS_PER_S = 50.0
"""Of all peers together; further ones wait for their turn."""
KEEP_ALIVE_S = 75.0
SHUTDOWN_S = 1.0
LARGEST_BODY = 1024


def http_log() -> logging.Logger:
    """Return a log of our own errors only: what strangers send is not logged."""
    log = logging.getLogger(f"{__name__}.http")
    if not log.filters:
        log.addFilter(_is_our_own_error)
    return log


def _is_our_own_error(record: logging.LogRecord) -> bool:
    error = record.exc_info[1] if record.exc_info else None
    return not isinstance(error, HttpProcessingError)


class Connections:
    """Makes the protocol of each new connection; a factory for `loop.create_server`.

    Where there are as many as may be, the oldest that has shown no key yields to a new one, and
    where all have, the oldest that only watches: whoever takes places and does not even read what
    was asked for keeps nobody out, and who watches keeps out nobody who takes part.
    """

    def __init__(self, most: int, first_request_s: float) -> None:
        """Allow `most` connections at once, each of which asks for something within that time."""
        self._most = most
        self._first_request_s = first_request_s
        self._silent: dict[asyncio.BaseProtocol, asyncio.TimerHandle] = {}
        self._paired: dict[asyncio.BaseProtocol, ViewRole] = {}
        self._sent_away: set[asyncio.BaseProtocol] = set()
        self.server: web.Server | None = None
        """Talks to the connections; set once it exists."""

    def __call__(self) -> asyncio.BaseProtocol:
        """Return the protocol of a new connection."""
        if self.server is None or not self._has_room(self.server.connections):
            return _Refused()
        protocol = self.server()
        self._silent[protocol] = asyncio.get_running_loop().call_later(
            self._first_request_s, self._end_if_silent, protocol
        )
        return protocol

    def note(self, request: web.BaseRequest) -> None:
        """Note that a connection has requested something."""
        timer = self._silent.pop(request.protocol, None)
        if timer is not None:
            # It would keep a connection that has long ended in memory.
            timer.cancel()

    def note_key(self, request: web.BaseRequest, role: ViewRole) -> None:
        self._paired[request.protocol] = role

    def _has_room(self, there: list[web.RequestHandler]) -> bool:
        """Return whether one more connection is allowed; a less important one makes room for it."""
        self._paired = {each: self._paired[each] for each in there if each in self._paired}
        self._sent_away.intersection_update(there)
        if len(there) - len(self._sent_away) < self._most:
            return True
        may_yield = [each for each in there if each not in self._sent_away]
        for role in (None, ViewRole.SPECTATOR, ViewRole.BOARD):
            oldest = next((each for each in may_yield if self._paired.get(each) is role), None)
            if oldest is not None:
                break
        else:
            return False
        self._sent_away.add(oldest)
        _send_away(oldest)
        return True

    def _end_if_silent(self, protocol: web.RequestHandler) -> None:
        if self._silent.pop(protocol, None) is not None:
            protocol.force_close()


def _send_away(protocol: web.RequestHandler) -> None:
    """End a connection to which something may be in transit."""
    if protocol.transport is not None:
        # Closed, it would wait for its peer to read; so the pending write fails.
        with contextlib.suppress(OSError):
            protocol.transport.get_extra_info("socket").shutdown(socket.SHUT_RDWR)


class _Refused(asyncio.Protocol):
    """Ends a connection at once."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        transport.close()


class LimitedServer:
    """An HTTP server on any number of ports, within limits of what connections may cost."""

    def __init__(
        self,
        limits: ViewLimits,
        check: Middleware,
        routes: Sequence[web.AbstractRouteDef],
        largest_body: int,
    ) -> None:
        """Make a server; nothing listens yet.

        Args:
            limits: what connections may cost.
            check: sees every request in its turn, before its handler.
            routes: what is answered.
            largest_body: of a request, in bytes.
        """
        self._handshake_s = limits.first_message_s
        self.connections = Connections(limits.connections, limits.first_message_s)
        self._requests = AsyncRateLimiter(REQUESTS_PER_S)
        app = web.Application(middlewares=[self._admit, check], client_max_size=largest_body)
        app.on_response_prepare.append(add_security_headers)
        app.add_routes(routes)
        self._runner = web.AppRunner(
            app,
            access_log=None,
            logger=http_log(),
            keepalive_timeout=KEEP_ALIVE_S,
            shutdown_timeout=SHUTDOWN_S,
        )
        self._listeners: list[Listener] = []

    @web.middleware
    async def _admit(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        self.connections.note(request)
        await self._requests.passed()
        return await handler(request)

    async def listen(self, host: str, port: int, tls: ssl.SSLContext | None = None) -> int:
        """Listen, by TLS where there is a certificate; return on which port, 0 is any free one."""
        listener = Listener(self.connections, NEW_CONNECTIONS_PER_S, tls, self._handshake_s)
        try:
            found = await listener.listen(host, port)
        except (OSError, OverflowError) as error:
            raise InputError(f"Cannot listen on {host}:{port}: {error}.") from None
        self._listeners.append(listener)
        if self.connections.server is None:
            await self._runner.setup()
            self.connections.server = self._runner.server
        return found

    def stop_listening(self) -> None:
        """Take no further connection."""
        for listener in self._listeners:
            listener.close()

    async def close(self) -> None:
        """End what is still connected."""
        await self._runner.cleanup()


class GuardedServer(LimitedServer):
    """A server that serves only paired clients, except for the page and the pairing."""

    def __init__(
        self,
        sessions: Sessions,
        code: PairingCode,
        limits: ViewLimits,
        routes: Sequence[web.RouteDef],
        page: Path | None,
    ) -> None:
        """Make a server; nothing listens yet.

        Args:
            sessions: whose keys let somebody through.
            code: that a new session is given for, at `POST /pair`.
            limits: what connections may cost.
            routes: what else is answered.
            page: folder of the built page, whose files are public; None where there is none.
        """
        self._sessions = sessions
        self._code = code
        static = [] if page is None else [web.static("/", page)]
        paths = [web.post("/pair", self._pair), *routes, *static]
        super().__init__(limits, self._check, paths, LARGEST_BODY)

    @web.middleware
    async def _check(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        """Refuse what comes from elsewhere or without a session's key."""
        check_origin(request)
        role = self._sessions.role(session_key(request))
        if role is not None:
            request[ROLE] = role
            self.connections.note_key(request, role)
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
        response = web.json_response({"key": key}, headers={hdrs.CACHE_CONTROL: "no-store"})
        response.set_cookie(
            COOKIE, key, path="/", httponly=True, samesite="Strict", secure=request.secure
        )
        return response


def page_answer(page: Path | None, name: str) -> web.StreamResponse:
    """Return a file of the built page, or a note that it has not been built."""
    if page is None:
        return web.Response(text=NOT_BUILT, content_type="text/html")
    return web.FileResponse(page / name)
