"""The teacher's board: a page of live tiles, the seats' scenes, and orders to the seats.

The browser sees a seat's scene by way of the board, which has the key; nothing that it sends goes
to the seat. The page and its code are the board's own; only the scene, sounds, pictures and what
moves come from the simulator.
"""

from __future__ import annotations

import asyncio
import contextlib
import secrets
from collections.abc import Callable
from pathlib import Path

import aiohttp
from aiohttp import WSMsgType, hdrs, web
from aiohttp.typedefs import Handler

from rastrainer.errors import InputError
from rastrainer.study.database.database import StudyPlace
from rastrainer_simulator.assets import page_folder
from rastrainer_simulator.board.board_messages import (
    BOARD_SUBPROTOCOL,
    NewSeat,
    SeatOrder,
    TilesNews,
)
from rastrainer_simulator.board.class_table import ClassWatch
from rastrainer_simulator.board.seats import (
    RefusedError,
    SeatClient,
    SeatEntry,
    WatchedSeat,
    checked_address,
    checked_fingerprint,
    read_seats,
    write_seats,
)
from rastrainer_simulator.net.views.access_control import (
    ROLE,
    PairingCode,
    Sessions,
    fresh_json,
    open_socket,
    read_body,
)
from rastrainer_simulator.net.views.guarded_server import GuardedServer, page_answer
from rastrainer_simulator.presentation.messages import (
    SUBPROTOCOL,
    Hello,
    OrderRequest,
    ViewRole,
    message_text,
    read_view_input,
)

TILES_S = 0.25
"""Time between two messages to a teacher's page."""
HEARTBEAT_S = 20.0
SEAT_PATH = "/seat/{seat:[0-9a-f]{12}}"
FILES = (
    "scene/{name:[0-9a-f]{64}}.glb",
    "sounds/{name:[a-z-]{1,32}}.wav",
    "scenarios/{name:[a-z0-9-]{1,40}}.png",
)
"""Files that a page may request from a simulator."""
FILE_TYPES = {"glb": "model/gltf-binary", "wav": "audio/wav", "png": "image/png"}
"""Their types; the simulator's own statement is ignored."""
_KEPT_HEADERS = (hdrs.CONTENT_ENCODING, hdrs.CACHE_CONTROL, hdrs.VARY, "X-File-Size")
_SPECTATOR_HELLO = message_text(Hello("spectator"))
_HELLO_S = 5.0
SPECTATORS_ONLY = "This stream is only for watching: the first message must be a spectator's hello."
ONLY_TEACHERS = "This browser only watches the board: pair it with the board again."


class BoardServer:
    """Watches the seats of a list, and serves the board's page."""

    def __init__(
        self,
        config: Path,
        client: SeatClient,
        on_new_code: Callable[[str], None],
        study: StudyPlace | None = None,
    ) -> None:
        """Watch the seats in the folder of settings, and the class of a study if there is one."""
        self._client = client
        self._config = config
        self._changed = asyncio.Event()
        self._pages: set[asyncio.Event] = set()
        self._seats = {
            entry.id: WatchedSeat(entry, self._client, self._notify) for entry in read_seats(config)
        }
        self._pins: dict[str, str] = {}
        self._class = ClassWatch(study)
        self._page = page_folder()
        self.code = PairingCode(asyncio.get_running_loop().time, on_new_code)
        routes = [
            web.get("/", self._send_page),
            web.get(f"{SEAT_PATH}/", self._send_page),
            web.get(f"{SEAT_PATH}/{{name:page\\.(?:js|css)}}", self._send_page),
            web.get(f"{SEAT_PATH}/role", self._send_role),
            web.get(f"{SEAT_PATH}/stream", self._stream),
            *(web.get(f"{SEAT_PATH}/{path}", self._send_file) for path in FILES),
            web.get("/tiles", self._send_tiles),
            web.get("/class", self._class.send),
            # A browser cannot read its cookie; without one it is refused.
            web.get("/paired", _send_nothing),
            web.post("/seats", _for_teachers(self._add)),
            web.delete(SEAT_PATH, _for_teachers(self._remove)),
            web.post(f"{SEAT_PATH}/order", _for_teachers(self._order)),
        ]
        self._http = GuardedServer(Sessions(), self.code, routes, self._page)

    async def listen(self, host: str, port: int) -> int:
        await self._class.begin()
        return await self._http.listen(host, port)

    async def close(self) -> None:
        self._http.stop_listening()
        await asyncio.gather(*(seat.close() for seat in self._seats.values()))
        await self._http.close()
        await self._class.close()

    def _notify(self) -> None:
        for page in self._pages:
            page.set()

    def _entry(self, request: web.Request) -> SeatEntry:
        seat = self._seats.get(request.match_info["seat"])
        if seat is None:
            raise web.HTTPNotFound(text="There is no such seat on this board.")
        return seat.entry

    async def _send_page(self, request: web.Request) -> web.StreamResponse:
        if "seat" not in request.match_info:
            return page_answer(self._page, "board.html")
        self._entry(request)
        return page_answer(self._page, request.match_info.get("name", "index.html"))

    async def _send_role(self, request: web.Request) -> web.Response:
        self._entry(request)
        return fresh_json({"role": ViewRole.SPECTATOR.value})

    async def _send_file(self, request: web.Request) -> web.Response:
        entry = self._entry(request)
        path = request.path.removeprefix(f"/seat/{entry.id}")
        try:
            content, found = await self._client.request(entry, path)
        except RefusedError:
            raise web.HTTPNotFound from None
        except InputError as error:
            raise web.HTTPBadGateway(text=str(error)) from None
        headers = {name: found[name] for name in _KEPT_HEADERS if name in found}
        kind = FILE_TYPES[path.rpartition(".")[2]]
        return web.Response(body=content, content_type=kind, headers=headers)

    async def _stream(self, request: web.Request) -> web.StreamResponse:
        entry = self._entry(request)
        try:
            simulator = await self._client.stream(entry)
        except InputError as error:
            raise web.HTTPBadGateway(text=str(error)) from None
        hello, page = None, None
        try:
            page = await open_socket(request, SUBPROTOCOL, compress=False)
            with contextlib.suppress(asyncio.TimeoutError):
                first = await page.receive(_HELLO_S)
                hello = read_view_input(first.data) if first.type is WSMsgType.TEXT else None
            if not isinstance(hello, Hello) or hello.kind != "spectator":
                raise InputError(SPECTATORS_ONLY)
            await simulator.send_str(_SPECTATOR_HELLO)
            await _pass_on(simulator, page)
            await page.close()
        except InputError as error:
            assert page is not None, "the refusal is of what the page has sent"
            await page.close(code=1008, message=str(error).encode()[:120])
        finally:
            await simulator.close()
        return page

    async def _send_tiles(self, request: web.Request) -> web.StreamResponse:
        socket = await open_socket(
            request, BOARD_SUBPROTOCOL, max_msg_size=1024, heartbeat=HEARTBEAT_S
        )
        is_changed = asyncio.Event()
        is_changed.set()
        self._pages.add(is_changed)

        async def send() -> None:
            with contextlib.suppress(ConnectionError):
                while True:
                    await is_changed.wait()
                    is_changed.clear()
                    tiles = TilesNews(tuple(seat.tile() for seat in self._seats.values()))
                    await socket.send_str(message_text(tiles))
                    await asyncio.sleep(TILES_S)

        sending = asyncio.create_task(send())
        try:
            async for _message in socket:
                # A board's page has nothing to send here.
                await socket.close(code=1008, message=b"Nothing is to be sent here.")
        finally:
            self._pages.discard(is_changed)
            sending.cancel()
            await asyncio.gather(sending, return_exceptions=True)
        return socket

    async def _add(self, request: web.Request) -> web.Response:
        """Pair with a simulator. Without its fingerprint, return it for comparison."""
        asked = await read_body(request, NewSeat)
        name, address = asked.name.strip(), checked_address(asked.address)
        fingerprint = ""
        if address.startswith("https:"):
            if not asked.fingerprint:
                shown = await self._client.fingerprint(address)
                return web.json_response({"fingerprint": shown})
            fingerprint = checked_fingerprint(asked.fingerprint)
        key = await self._client.pair(address, fingerprint, asked.code)
        entries = {seat.entry.address: seat.entry for seat in self._seats.values()}
        known = entries.get(address)
        seat_id = secrets.token_hex(6) if known is None else known.id
        entry = SeatEntry(seat_id, name or address, address, key, fingerprint)
        write_seats(self._config, {**entries, address: entry}.values())
        await self._forget(entry.id)
        self._seats[entry.id] = WatchedSeat(entry, self._client, self._notify)
        self._notify()
        return web.json_response({"id": entry.id})

    async def _remove(self, request: web.Request) -> web.Response:
        entry = self._entry(request)
        others = [seat.entry for seat in self._seats.values() if seat.entry is not entry]
        write_seats(self._config, others)
        await self._forget(entry.id)
        self._notify()
        return web.json_response({})

    async def _forget(self, seat: str) -> None:
        self._pins.pop(seat, None)
        watched = self._seats.pop(seat, None)
        if watched is not None:
            await watched.close()

    async def _order(self, request: web.Request) -> web.Response:
        """Have something done at a seat; its PIN is remembered until the board ends."""
        entry = self._entry(request)
        asked = await read_body(request, SeatOrder)
        pin = asked.pin or self._pins.get(entry.id, "")
        if not pin:
            return web.json_response({"needsPin": True})
        order = OrderRequest(pin, asked.order, asked.text)
        try:
            await self._client.request(entry, "/instructor", order)
        except RefusedError:
            self._pins.pop(entry.id, None)
            raise
        self._pins[entry.id] = pin
        return web.json_response({})


async def _send_nothing(_request: web.Request) -> web.Response:
    return fresh_json({})


def _for_teachers(act: Handler) -> Handler:
    """Refuse browsers that only watch; say why something could not be done."""

    async def handle(request: web.Request) -> web.StreamResponse:
        if request[ROLE] is not ViewRole.VIEW:
            raise web.HTTPForbidden(text=ONLY_TEACHERS)
        try:
            return await act(request)
        except InputError as error:
            raise web.HTTPConflict(text=str(error)) from None

    return handle


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
