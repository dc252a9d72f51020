"""Listen for HTTP within limits of connections, requests and sizes; behind a gate or not."""

from __future__ import annotations

import ssl
from collections.abc import Sequence
from pathlib import Path

from aiohttp import web
from aiohttp.typedefs import Middleware

from rastrainer.errors import InputError
from rastrainer_simulator.loop.timing import AsyncRateLimiter
from rastrainer_simulator.net.limits import ViewLimits
from rastrainer_simulator.net.listener import Listener
from rastrainer_simulator.net.views.connections import KEEP_ALIVE_S, Connections, http_log
from rastrainer_simulator.net.views.gate import Gate, PairingCode, add_security_headers
from rastrainer_simulator.net.views.sessions import Sessions

SHUTDOWN_S = 1.0
LARGEST_BODY = 1024


class LimitedServer:
    """An HTTP server on any number of ports."""

    def __init__(
        self,
        connections: Connections,
        limits: ViewLimits,
        check: Middleware,
        routes: Sequence[web.AbstractRouteDef],
        largest_body: int,
    ) -> None:
        """Make a server; nothing listens yet.

        Args:
            connections: that there are; `check` notes each request there.
            limits: what connections may cost.
            check: sees every request first.
            routes: what is answered.
            largest_body: of a request, in bytes.
        """
        self._limits = limits
        self._connections = connections
        app = web.Application(middlewares=[check], client_max_size=largest_body)
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

    async def listen(self, host: str, port: int, tls: ssl.SSLContext | None = None) -> int:
        """Listen, by TLS where there is a certificate; return on which port, 0 is any free one.

        Raises:
            InputError: the address cannot be listened on.
        """
        listener = Listener(
            self._connections,
            self._limits.new_connections_per_s,
            tls,
            self._limits.first_message_s,
        )
        try:
            found = await listener.listen(host, port)
        except (OSError, OverflowError) as error:
            raise InputError(f"Cannot listen on {host}:{port}: {error}.") from None
        self._listeners.append(listener)
        if self._connections.server is None:
            await self._runner.setup()
            self._connections.server = self._runner.server
        return found

    def stop_listening(self) -> None:
        """Take no further connection."""
        for listener in self._listeners:
            listener.close()

    async def close(self) -> None:
        """End what is still connected."""
        await self._runner.cleanup()


class GuardedServer(LimitedServer):
    """A server that lets through nobody but who is paired, except to the page and the pairing."""

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
        connections = Connections(limits.connections, limits.first_message_s)
        gate = Gate(
            sessions,
            code,
            connections.note,
            connections.note_key,
            AsyncRateLimiter(limits.requests_per_s),
        )
        static = [] if page is None else [web.static("/", page)]
        paths = [web.post("/pair", gate.pair), *routes, *static]
        super().__init__(connections, limits, gate.check, paths, LARGEST_BODY)
