"""HTTP and the stream, in the simulator's event loop."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import ssl
from collections.abc import Callable
from pathlib import Path

from aiohttp import WSCloseCode, WSMsgType, web

from rastrainer.errors import InputError
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.control_loop import ControlLoop
from rastrainer_simulator.igtl.state_feed import StateFeed
from rastrainer_simulator.scene.cache_folder import cache_folder
from rastrainer_simulator.scene.scene_files import SceneFiles, read_scene
from rastrainer_simulator.view_server.connections import KEEP_ALIVE_S, Connections, http_log
from rastrainer_simulator.view_server.gate import Gate
from rastrainer_simulator.view_server.limits import ViewLimits
from rastrainer_simulator.view_server.messages import HELLO, SUBPROTOCOL, check_message
from rastrainer_simulator.view_server.operator_desk import Hello, OperatorDesk
from rastrainer_simulator.view_server.page import NOT_BUILT, page_folder
from rastrainer_simulator.view_server.pairing import PairingCode
from rastrainer_simulator.view_server.security_headers import add_security_headers
from rastrainer_simulator.view_server.sessions import Sessions
from rastrainer_simulator.view_server.view import View
from rastrainer_simulator.view_server.views import Views

FOREVER = "private, max-age=31536000, immutable"
FULL = "As many views as can be served are connected."
HELLO_FIRST = "The first message of a view must be a hello."
LARGEST_BODY = 1024
SHUTDOWN_S = 1.0


class ViewServer:
    """Serves the page, the scene, the sounds and the stream.

    Attributes:
        code: pairs a view; to be shown to people.
        sessions: keys of the views that may look.
        port: where it listens; 0 before it does.
    """

    def __init__(
        self,
        control_loop: ControlLoop,
        desk: OperatorDesk,
        on_new_code: Callable[[str], None],
        robot_meshes: Path | None = None,
        limits: ViewLimits | None = None,
    ) -> None:
        """Make a server, in the event loop's thread; nothing listens yet.

        Args:
            control_loop: whose states are told.
            desk: what the views' input goes to, and where their screens come from.
            on_new_code: is given a pairing code that replaces `code`, to be shown.
            robot_meshes: those that the setups are loaded with.
            limits: what views may cost.
        """
        self._control_loop = control_loop
        self._desk = desk
        self._limits = limits or ViewLimits()
        self.code = PairingCode(asyncio.get_running_loop().time, on_new_code)
        self.sessions = Sessions(self._limits.sessions)
        self.port = 0
        self._scenes = SceneFiles(cache_folder(), robot_meshes)
        self._views = Views(control_loop, desk, self._scenes, self._limits)
        self._streams = 0
        self._page = page_folder()
        self._connections = Connections(self._limits.connections, self._limits.first_message_s)
        self._runner = web.AppRunner(
            self._application(),
            access_log=None,
            logger=http_log(),
            keepalive_timeout=KEEP_ALIVE_S,
            shutdown_timeout=SHUTDOWN_S,
        )
        self._servers: list[asyncio.Server] = []
        self._unsubscribe: Callable[[], None] = lambda: None

    async def listen(self, host: str, port: int) -> int:
        """Listen, and return on which port; 0 is any free one.

        Raises:
            InputError: the address cannot be listened on.
        """
        self.port = await self._open(host, port, None)
        await self._runner.setup()
        self._connections.server = self._runner.server
        feed = StateFeed(self._views.is_due, self._views.tell, asyncio.get_running_loop())
        self._unsubscribe = self._control_loop.subscribe(feed)
        return self.port

    async def listen_in_network(self, port: int, tls: ssl.SSLContext) -> int:
        """Listen to other computers, too, by TLS only; return on which port.

        Raises:
            InputError: the port cannot be listened on.
        """
        return await self._open("0.0.0.0", port, tls)

    async def close(self) -> None:
        """Send the views away and stop listening."""
        self._unsubscribe()
        for server in self._servers:
            server.close()
        await self._views.close()
        await self._runner.cleanup()

    async def _open(self, host: str, port: int, tls: ssl.SSLContext | None) -> int:
        loop = asyncio.get_running_loop()
        try:
            server = await loop.create_server(self._connections, host, port, ssl=tls)
        except (OSError, OverflowError) as error:
            raise InputError(f"Views cannot be served on {host}:{port}: {error}.") from None
        self._servers.append(server)
        return server.sockets[0].getsockname()[1]

    def _application(self) -> web.Application:
        gate = Gate(self.sessions, self.code, self._connections.note)
        app = web.Application(middlewares=[gate.check], client_max_size=LARGEST_BODY)
        app.on_response_prepare.append(add_security_headers)
        app.add_routes(
            [
                web.get("/", self._send_page),
                web.post("/pair", gate.pair),
                web.get("/scene/{sha256:[0-9a-f]{64}}.glb", self._send_scene),
                web.get("/sounds/{name:[a-z-]{1,32}}.wav", self._send_sound),
                web.get("/stream", self._stream),
            ]
        )
        if self._page is not None:
            app.add_routes([web.static("/", self._page)])
        return app

    async def _send_page(self, _request: web.Request) -> web.StreamResponse:
        if self._page is None:
            return web.Response(text=NOT_BUILT, content_type="text/html")
        return web.FileResponse(self._page / "index.html")

    async def _send_scene(self, request: web.Request) -> web.Response:
        file = self._scenes.find(request.match_info["sha256"])
        content = None if file is None else await asyncio.to_thread(read_scene, file)
        if content is None:
            raise web.HTTPNotFound
        return web.Response(
            body=content,
            content_type="model/gltf-binary",
            headers={"Cache-Control": FOREVER},
        )

    async def _send_sound(self, request: web.Request) -> web.StreamResponse:
        path = asset_path("sounds", f"{request.match_info['name']}.wav")
        if not path.is_file():
            raise web.HTTPNotFound
        return web.FileResponse(path)

    async def _stream(self, request: web.Request) -> web.StreamResponse:
        stream = web.WebSocketResponse(
            protocols=(SUBPROTOCOL,),
            max_msg_size=self._limits.message_bytes,
            heartbeat=self._limits.gone_s / 2.0,
            compress=False,
            # Every message waits until the one before it has left: only so the latest is sent.
            writer_limit=0,
        )
        if stream.can_prepare(request).protocol != SUBPROTOCOL:
            raise web.HTTPBadRequest(text=f"Ask for a WebSocket with {SUBPROTOCOL}.")
        if self._streams >= self._limits.views:
            raise web.HTTPServiceUnavailable(text=FULL)
        self._streams += 1
        try:
            await stream.prepare(request)
            self._keep_little_waiting(request)
            await self._serve(stream)
        finally:
            self._streams -= 1
        return stream

    async def _serve(self, stream: web.WebSocketResponse) -> None:
        try:
            hello = await self._first_message(stream)
        except InputError as error:
            await stream.close(code=WSCloseCode.POLICY_VIOLATION, message=str(error).encode()[:120])
            return
        view = View(self._views.next_number(), stream, self._desk, self._limits)
        await self._views.serve(view, hello)

    async def _first_message(self, stream: web.WebSocketResponse) -> Hello:
        try:
            first = await stream.receive(self._limits.first_message_s)
        except asyncio.TimeoutError:
            raise InputError(HELLO_FIRST) from None
        if first.type is not WSMsgType.TEXT:
            raise InputError(HELLO_FIRST)
        received = check_message(first.data)
        if received.type != HELLO:
            raise InputError(HELLO_FIRST)
        return Hello(*received.values)

    def _keep_little_waiting(self, request: web.Request) -> None:
        transport = request.transport
        if transport is None:
            return
        transport.set_write_buffer_limits(high=0)
        with contextlib.suppress(OSError):
            peer = transport.get_extra_info("socket")
            peer.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, self._limits.buffer_bytes)
