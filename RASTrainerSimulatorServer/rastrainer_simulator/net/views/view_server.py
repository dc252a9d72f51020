"""The HTTP server of views: page, scene, sounds, pictures and streams."""

from __future__ import annotations

import asyncio
import contextlib
import gzip
import socket
import ssl
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from aiohttp import WSCloseCode, WSMsgType, web

from rastrainer.errors import InputError
from rastrainer.protocol import DEFAULT_HOST, DEFAULT_VIEW_PORT
from rastrainer_simulator.assets import asset_path, page_folder
from rastrainer_simulator.loop.results import StateFeed, StateSource
from rastrainer_simulator.net.limits import ViewLimits
from rastrainer_simulator.net.listener import is_loopback
from rastrainer_simulator.net.views.access_control import (
    BOARDS_FILE,
    ROLE,
    PairingCode,
    Sessions,
    fresh_json,
    open_socket,
)
from rastrainer_simulator.net.views.boards import instructor_orders
from rastrainer_simulator.net.views.guarded_server import GuardedServer, page_answer
from rastrainer_simulator.net.views.joined_views import JoinedViews
from rastrainer_simulator.ops.instructor_pin import InstructorPin
from rastrainer_simulator.presentation.messages import (
    SUBPROTOCOL,
    WATCHING_KINDS,
    Hello,
    ViewRole,
    read_view_input,
)
from rastrainer_simulator.presentation.presenter import Presenter
from rastrainer_simulator.scene.scene_files import SceneFiles, gzipped_scene, scenes_folder

FOREVER = "private, max-age=31536000, immutable"
FULL_SIZE = "X-File-Size"
SPECTATORS = 16
"""Streams at a time of those who were paired to watch only, as spectators or as boards."""
FIRST_MESSAGE_S = 5.0
"""Time that a view has for its hello."""
MAX_MESSAGE_BYTES = 16 * 1024
SEND_BUFFER_BYTES = 32 * 1024
"""Passed to the operating system ahead of a view that reads slowly."""
FULL = "The maximum number of views is connected."
HELLO_FIRST = "The first message of a view must be a hello."
ONLY_WATCHES = f"This key only watches: the kind of the view must be {' or '.join(WATCHING_KINDS)}."


class ViewServer:
    """Serves the page, the scene, the sounds, pictures of scenarios and the stream.

    Browsers find the page at its `addresses`, such as "http://127.0.0.1:18945".
    """

    def __init__(
        self,
        source: StateSource,
        presenter: Presenter,
        announce: Callable[[str], None],
        robot_meshes: Path | None = None,
        limits: ViewLimits | None = None,
        scenario_picture: Callable[[str], Path | None] = lambda _name: None,
        config: Path | None = None,
        pin: InstructorPin | None = None,
    ) -> None:
        """Make a server, in the event loop's thread; nothing listens yet.

        `announce` is given what people must know, such as pairing codes. Without `config`, the
        folder of settings, no keys of boards are kept; without `pin` boards give no orders.
        """
        self._scenario_picture = scenario_picture
        self._source = source
        self._presenter = presenter
        self._announce = announce
        self._limits = limits or ViewLimits()
        self.code = PairingCode(asyncio.get_running_loop().time, self._renewed)
        self.addresses: list[str] = []
        self.sessions = Sessions(None if config is None else config / BOARDS_FILE)
        self.port = 0
        self._scenes = SceneFiles(scenes_folder(), robot_meshes)
        self._views = JoinedViews(source, presenter, self._scenes, self._limits)
        self._streams: Counter[ViewRole] = Counter()
        self._page = page_folder()
        routes = [
            web.get("/", self._send_page),
            web.get("/scene/{sha256:[0-9a-f]{64}}.glb", self._send_scene),
            web.get("/sounds/{name:[a-z-]{1,32}}.wav", self._send_file),
            web.get("/scenarios/{name:[a-z0-9-]{1,40}}.png", self._send_file),
            web.get("/role", _send_role),
            web.post("/instructor", instructor_orders(pin, presenter)),
            web.get("/stream", self._stream),
        ]
        self._http = GuardedServer(self.sessions, self.code, routes, self._page)
        self._unsubscribe: Callable[[], None] = lambda: None

    async def start(self, port: int | None, certificates: Path | None = None) -> None:
        """Listen on this computer, and with a folder for certificates to the local network.

        The network is served by TLS, on the next port or, if that is taken, any free one. `port` 0
        is any free one, None the usual one or, where that is taken, any free one.
        """
        usual = DEFAULT_VIEW_PORT if port is None else port
        local = await self.listen(DEFAULT_HOST, usual, or_any=port is None)
        where = f"http://{DEFAULT_HOST}:{local}"
        self._announce(f"serves views on {where}, pairing code {self.code.code}")
        if certificates is None:
            return
        from rastrainer_simulator.net.views.certificate import own_addresses, own_certificate

        certificate = await asyncio.to_thread(own_certificate, certificates)
        found = await self.listen_in_network(local + 1, certificate.tls)
        addresses = [address for address in own_addresses() if ":" not in address]
        pages = [f"https://{name}:{found}" for name in addresses or [socket.gethostname()]]
        self.add_addresses(*pages)
        self._announce(
            f"serves the local network on {' or '.join(pages)}; the browser warns of a certificate "
            f"made here: compare its SHA-256 fingerprint, {certificate.fingerprint}"
        )
        self._announce(
            f"serves a headset on a USB cable: adb reverse tcp:{local} tcp:{local}, then open "
            f"http://localhost:{local} in its browser"
        )

    async def listen(self, host: str, port: int, or_any: bool = False) -> int:
        self.port = await self._http.listen(host, port, or_any=or_any)
        self.add_addresses(f"http://{host}:{self.port}")
        feed = StateFeed(self._views.is_due, self._views.tell, asyncio.get_running_loop())
        self._unsubscribe = self._source.subscribe(feed)
        return self.port

    async def listen_in_network(self, port: int, tls: ssl.SSLContext) -> int:
        """Listen to other computers, too, by TLS only; on any port if that one is taken."""
        return await self._http.listen("0.0.0.0", port, tls, or_any=True)

    def add_addresses(self, *addresses: str) -> None:
        """Send this computer's views where else browsers find the page."""
        self.addresses += addresses
        self._views.announce_pairing(self.code.code, self.addresses)

    async def close(self) -> None:
        self._unsubscribe()
        self._http.stop_listening()
        await self._views.close()
        await self._http.close()

    def _renewed(self, code: str) -> None:
        self._announce(f"has a new pairing code for views: {code}")
        self._views.announce_pairing(code, self.addresses)

    async def _send_page(self, _request: web.Request) -> web.StreamResponse:
        return page_answer(self._page, "index.html")

    async def _send_scene(self, request: web.Request) -> web.Response:
        file = self._scenes.by_hash.get(request.match_info["sha256"])
        if file is None:
            raise web.HTTPNotFound
        headers = {"Cache-Control": FOREVER, "Vary": "Accept-Encoding"}
        try:
            content, size = await asyncio.to_thread(gzipped_scene, file)
        except LookupError:
            raise web.HTTPNotFound from None
        if "gzip" in request.headers.get("Accept-Encoding", ""):
            # The size is for views that show the progress of the download.
            headers |= {"Content-Encoding": "gzip", FULL_SIZE: str(size)}
        else:
            content = await asyncio.to_thread(gzip.decompress, content)
        return web.Response(body=content, content_type="model/gltf-binary", headers=headers)

    async def _send_file(self, request: web.Request) -> web.StreamResponse:
        name, is_sound = request.match_info["name"], request.path.endswith(".wav")
        path = asset_path("sounds", f"{name}.wav") if is_sound else self._scenario_picture(name)
        if path is None or not path.is_file():
            raise web.HTTPNotFound
        return web.FileResponse(path, headers=None if is_sound else {"Content-Type": "image/png"})

    async def _stream(self, request: web.Request) -> web.StreamResponse:
        role = request[ROLE]
        if self._streams[role] >= (SPECTATORS if role is not ViewRole.VIEW else self._limits.views):
            raise web.HTTPServiceUnavailable(text=FULL)
        self._streams[role] += 1
        try:
            stream = await open_socket(
                request,
                SUBPROTOCOL,
                max_msg_size=MAX_MESSAGE_BYTES,
                heartbeat=self._limits.gone_s / 2.0,
                compress=False,
                # Pings are answered by the view, where they count as any message does.
                autoping=False,
            )
            _limit_buffering(request)
            try:
                hello = await _first_message(stream, role)
            except InputError as error:
                reason = str(error).encode()[:120]
                await stream.close(code=WSCloseCode.POLICY_VIOLATION, message=reason)
            else:
                is_local = is_loopback(request.remote or "")
                await self._views.serve(stream, hello, is_local)
        finally:
            self._streams[role] -= 1
        return stream


async def _first_message(stream: web.WebSocketResponse, role: ViewRole) -> Hello:
    try:
        first = await stream.receive(FIRST_MESSAGE_S)
    except asyncio.TimeoutError:
        raise InputError(HELLO_FIRST) from None
    hello = read_view_input(first.data) if first.type is WSMsgType.TEXT else None
    if not isinstance(hello, Hello):
        raise InputError(HELLO_FIRST)
    if role is not ViewRole.VIEW and hello.kind not in WATCHING_KINDS:
        raise InputError(ONLY_WATCHES)
    return hello


def _limit_buffering(request: web.Request) -> None:
    transport = request.transport
    if transport is None:
        return
    under_tls = getattr(getattr(transport, "_ssl_protocol", None), "_transport", None)
    if under_tls is None:
        transport.set_write_buffer_limits(high=0)
    else:
        # With 0, asyncio's TLS holds back every other message until the view sends something.
        transport.set_write_buffer_limits(high=1)
        under_tls.set_write_buffer_limits(high=0)
    with contextlib.suppress(OSError):
        peer = transport.get_extra_info("socket")
        peer.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER_BYTES)


async def _send_role(request: web.Request) -> web.Response:
    """Return to a browser, which cannot read its cookie, the role it was paired for."""
    return fresh_json({"role": request[ROLE].value})
