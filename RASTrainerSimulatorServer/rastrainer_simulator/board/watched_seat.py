"""One watched simulator: the state of its seat, and its scene in a teacher's browser.

The browser sees the scene by way of the board, which has the key. The page and its code are the
board's own; only the scene, sounds, pictures and what moves come from the simulator.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable

import aiohttp
from aiohttp import WSMsgType, hdrs, web

from rastrainer.errors import InputError
from rastrainer.json_checks import decode_message_object
from rastrainer.json_records import record_from_json
from rastrainer_simulator.assets import page_folder
from rastrainer_simulator.board.board_messages import SeatLink, TileNews
from rastrainer_simulator.board.seats import (
    OtherCertificateError,
    RefusedError,
    SeatClient,
    SeatEntry,
    UnpairedError,
)
from rastrainer_simulator.net.views.guarded_server import page_answer
from rastrainer_simulator.presentation.messages import (
    SUBPROTOCOL,
    Hello,
    SeatNews,
    ViewRole,
    message_text,
    read_view_input,
)

RETRY_S = 2.0
_BOARD_HELLO = message_text(Hello("board"))


class WatchedSeat:
    """Watches one simulator in a separate task.

    Attributes:
        entry: which one.
    """

    def __init__(self, entry: SeatEntry, client: SeatClient, changed: Callable[[], None]) -> None:
        """Start to watch; `changed` is called whenever the tile changes."""
        self.entry = entry
        self._client = client
        self._changed = changed
        self._link = SeatLink.CONNECTING
        self._seat: SeatNews | None = None
        self._task = asyncio.create_task(self._watch())

    def tile(self) -> TileNews:
        """Return what a board shows of it."""
        entry = self.entry
        return TileNews(entry.id, entry.name, entry.address, self._link, self._seat)

    async def close(self) -> None:
        self._task.cancel()
        await asyncio.gather(self._task, return_exceptions=True)

    async def _watch(self) -> None:
        while True:
            try:
                await self._watch_once()
                self._become(SeatLink.AWAY)
            except UnpairedError:
                self._become(SeatLink.UNPAIRED)
            except OtherCertificateError:
                self._become(SeatLink.OTHER_CERTIFICATE)
            except (InputError, aiohttp.ClientError, OSError):
                self._become(SeatLink.AWAY)
            await asyncio.sleep(RETRY_S)

    async def _watch_once(self) -> None:
        """Receive what the simulator sends until the connection ends."""
        stream = await self._client.stream(self.entry)
        try:
            await stream.send_str(_BOARD_HELLO)
            async for message in stream:
                if message.type is not aiohttp.WSMsgType.TEXT:
                    return
                values = decode_message_object(message.data, "The message of a simulator")
                if values.get("type") == SeatNews.type:
                    seat = record_from_json(SeatNews, values, "The seat")
                    self._become(SeatLink.WATCHING, seat)
        finally:
            await stream.close()

    def _become(self, link: SeatLink, seat: SeatNews | None = None) -> None:
        if (link, seat) != (self._link, self._seat):
            self._link, self._seat = link, seat
            self._changed()


SEAT_PATH = "/seat/{seat:[0-9a-f]{12}}"
FILES = {
    "/scene/{name:[0-9a-f]{64}}.glb": "model/gltf-binary",
    "/sounds/{name:[a-z-]{1,32}}.wav": "audio/wav",
    "/scenarios/{name:[a-z0-9-]{1,40}}.png": "image/png",
}
"""What a page may request of a simulator, and its type, whatever the simulator says."""
_KEPT_HEADERS = (hdrs.CONTENT_ENCODING, hdrs.CACHE_CONTROL, hdrs.VARY, "X-File-Size")
_SPECTATOR_HELLO = message_text(Hello("spectator"))
_HELLO_S = 5.0


class LiveView:
    """Answers the page of a seat; nothing that a page sends goes to the simulator."""

    def __init__(self, entry: Callable[[web.Request], SeatEntry], client: SeatClient) -> None:
        """`entry` returns the seat that a request is about; it raises 404 for an unknown one."""
        self._entry = entry
        self._client = client
        self._page = page_folder()

    def routes(self) -> list[web.RouteDef]:
        """Return what is answered."""
        return [
            web.get(f"{SEAT_PATH}/", self._send_page),
            web.get(f"{SEAT_PATH}/{{name:page\\.(?:js|css)}}", self._send_code),
            web.get(f"{SEAT_PATH}/role", self._send_role),
            web.get(f"{SEAT_PATH}/stream", self._stream),
            *(web.get(SEAT_PATH + path, self._sender(kind)) for path, kind in FILES.items()),
        ]

    async def _send_page(self, request: web.Request) -> web.StreamResponse:
        self._entry(request)
        return page_answer(self._page, "index.html")

    async def _send_code(self, request: web.Request) -> web.StreamResponse:
        if self._page is None:
            raise web.HTTPNotFound
        return web.FileResponse(self._page / request.match_info["name"])

    async def _send_role(self, request: web.Request) -> web.Response:
        self._entry(request)
        headers = {hdrs.CACHE_CONTROL: "no-store"}
        return web.json_response({"role": ViewRole.SPECTATOR.value}, headers=headers)

    def _sender(self, kind: str) -> Callable:
        async def send(request: web.Request) -> web.Response:
            entry = self._entry(request)
            path = request.path.removeprefix(f"/seat/{entry.id}")
            try:
                content, found = await self._client.request(entry, path)
            except RefusedError:
                raise web.HTTPNotFound from None
            except InputError as error:
                raise web.HTTPBadGateway(text=str(error)) from None
            headers = {name: found[name] for name in _KEPT_HEADERS if name in found}
            return web.Response(body=content, content_type=kind, headers=headers)

        return send

    async def _stream(self, request: web.Request) -> web.StreamResponse:
        entry = self._entry(request)
        page = web.WebSocketResponse(protocols=(SUBPROTOCOL,), compress=False, writer_limit=0)
        if page.can_prepare(request).protocol != SUBPROTOCOL:
            raise web.HTTPBadRequest(text=f"Ask for a WebSocket with {SUBPROTOCOL}.")
        try:
            simulator = await self._client.stream(entry)
        except InputError as error:
            raise web.HTTPBadGateway(text=str(error)) from None
        try:
            await page.prepare(request)
            await _expect_spectator(page)
            await simulator.send_str(_SPECTATOR_HELLO)
            await _pass_on(simulator, page)
        except InputError as error:
            await page.close(code=1008, message=str(error).encode()[:120])
        finally:
            await simulator.close()
        await page.close()
        return page


async def _expect_spectator(page: web.WebSocketResponse) -> None:
    """Wait for the hello of a page that only watches."""
    with contextlib.suppress(asyncio.TimeoutError):
        first = await page.receive(_HELLO_S)
        if first.type is WSMsgType.TEXT:
            hello = read_view_input(first.data)
            if isinstance(hello, Hello) and hello.kind == "spectator":
                return
    raise InputError(
        "This stream is only for watching: the first message must be a spectator's hello."
    )


async def _pass_on(simulator: aiohttp.ClientWebSocketResponse, page: web.WebSocketResponse) -> None:
    """Send the page what the simulator says, until one of them ends it.

    A page that reads slowly makes the simulator wait, which then sends only the latest.
    """

    async def send() -> None:
        with contextlib.suppress(ConnectionError):
            async for message in simulator:
                if message.type is WSMsgType.TEXT:
                    await page.send_str(message.data)

    async def ignore() -> None:
        async for _message in page:
            pass

    tasks = [asyncio.create_task(send()), asyncio.create_task(ignore())]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
