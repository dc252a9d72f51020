"""Listen for HTTP, and let through nobody but who is paired, except to the page and the pairing."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from aiohttp import web

from rastrainer_simulator.loop.rates import AsyncRateLimiter
from rastrainer_simulator.net.limits import ViewLimits
from rastrainer_simulator.net.views.connections import Connections
from rastrainer_simulator.net.views.gate import Gate, PairingCode
from rastrainer_simulator.net.views.limited_server import LimitedServer
from rastrainer_simulator.net.views.sessions import Sessions

LARGEST_BODY = 1024


class GuardedServer(LimitedServer):
    """An HTTP server behind a `Gate`, on any number of ports."""

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
