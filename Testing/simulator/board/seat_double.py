"""A stand-in for a simulator: it pairs with any board, and sends what a test gives it."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable

from aiohttp import web

from rastrainer_simulator.presentation.messages import SUBPROTOCOL
from Testing.free_port import free_port

HOST = "127.0.0.1"
WELCOME = json.dumps({"type": "welcome", "protocol": 1, "view": 1, "bodies": []})
KEY = "k" * 43


async def serve_seat(
    say: Callable[[web.WebSocketResponse], Awaitable[None]],
) -> tuple[web.AppRunner, int]:
    """Serve a seat that sends what `say` sends to a board; return its server and its port."""

    async def pair(_request: web.Request) -> web.Response:
        return web.json_response({"key": KEY})

    async def stream(request: web.Request) -> web.WebSocketResponse:
        socket = web.WebSocketResponse(protocols=(SUBPROTOCOL,))
        await socket.prepare(request)
        await socket.receive()
        await socket.send_str(WELCOME)
        await say(socket)
        return socket

    app = web.Application()
    app.add_routes([web.post("/pair", pair), web.get("/stream", stream)])
    runner, port = web.AppRunner(app, access_log=None, shutdown_timeout=0.1), free_port()
    await runner.setup()
    await web.TCPSite(runner, HOST, port).start()
    return runner, port
