"""The teacher's board: a page of live tiles, the seats' scenes, and orders to the seats."""

from __future__ import annotations

import asyncio
import contextlib
import secrets
from collections.abc import Callable
from pathlib import Path

from aiohttp import hdrs, web

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
    SeatList,
    checked_address,
    checked_fingerprint,
)
from rastrainer_simulator.board.watched_seat import SEAT_PATH, LiveView, WatchedSeat
from rastrainer_simulator.net.views.access_control import (
    ROLE,
    PairingCode,
    Sessions,
    read_body,
)
from rastrainer_simulator.net.views.guarded_server import GuardedServer, page_answer
from rastrainer_simulator.presentation.messages import OrderRequest, message_text

TILES_S = 0.25
"""Between two messages to a teacher's page."""
HEARTBEAT_S = 20.0
ONLY_TEACHERS = "This browser only watches the board: pair it with the board again."


class BoardServer:
    """Watches the seats of a list, and serves the board's page.

    Attributes:
        code: pairs a teacher's browser with the board.
    """

    def __init__(
        self,
        config: Path,
        client: SeatClient,
        on_new_code: Callable[[str], None],
        study: StudyPlace | None = None,
    ) -> None:
        """Watch the seats that the folder of settings lists; in the event loop's thread.

        Args:
            config: Folder of settings.
            client: Talks to the seats.
            on_new_code: Called with each new code for browsers.
            study: Whose trainees are the class; None for a board of seats alone.
        """
        self._client = client
        self._list = SeatList(config)
        self._changed = asyncio.Event()
        self._pages: set[asyncio.Event] = set()
        self._seats = {
            entry.id: WatchedSeat(entry, self._client, self._notify) for entry in self._list
        }
        self._pins: dict[str, str] = {}
        self._class = ClassWatch(study)
        self._page = page_folder()
        self.code = PairingCode(asyncio.get_running_loop().time, on_new_code)
        live = LiveView(self._entry, self._client)
        routes = [
            web.get("/", self._send_page),
            web.get("/tiles", self._send_tiles),
            web.get("/class", self._class.send),
            web.get("/paired", _confirm_pairing),
            web.post("/seats", self._add),
            web.delete(SEAT_PATH, self._remove),
            web.post(f"{SEAT_PATH}/order", self._order),
            *live.routes(),
        ]
        self._http = GuardedServer(Sessions(), self.code, routes, self._page)

    async def listen(self, host: str, port: int) -> int:
        """Listen and return the port; 0 is any free one."""
        await self._class.begin()
        return await self._http.listen(host, port)

    async def close(self) -> None:
        """Stop watching, and close the connections of all pages."""
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

    async def _send_page(self, _request: web.Request) -> web.StreamResponse:
        return page_answer(self._page, "board.html")

    async def _send_tiles(self, request: web.Request) -> web.StreamResponse:
        socket = web.WebSocketResponse(
            protocols=(BOARD_SUBPROTOCOL,), max_msg_size=1024, heartbeat=HEARTBEAT_S, writer_limit=0
        )
        if socket.can_prepare(request).protocol != BOARD_SUBPROTOCOL:
            raise web.HTTPBadRequest(text=f"Ask for a WebSocket with {BOARD_SUBPROTOCOL}.")
        await socket.prepare(request)
        is_changed = asyncio.Event()
        is_changed.set()
        self._pages.add(is_changed)
        sending = asyncio.create_task(self._keep_sending(socket, is_changed))
        try:
            async for _message in socket:
                # A board's page has nothing to send here.
                await socket.close(code=1008, message=b"Nothing is to be sent here.")
        finally:
            self._pages.discard(is_changed)
            sending.cancel()
            await asyncio.gather(sending, return_exceptions=True)
        return socket

    async def _keep_sending(self, socket: web.WebSocketResponse, is_changed: asyncio.Event) -> None:
        with contextlib.suppress(ConnectionError):
            while True:
                await is_changed.wait()
                is_changed.clear()
                tiles = TilesNews(tuple(seat.tile() for seat in self._seats.values()))
                await socket.send_str(message_text(tiles))
                await asyncio.sleep(TILES_S)

    async def _add(self, request: web.Request) -> web.Response:
        """Pair with a simulator. Without its fingerprint, return it for comparison."""
        _check_teacher(request)
        asked = await read_body(request, NewSeat)
        try:
            name, address = asked.name.strip(), checked_address(asked.address)
            fingerprint = ""
            if address.startswith("https:"):
                if not asked.fingerprint:
                    shown = await self._client.fingerprint(address)
                    return web.json_response({"fingerprint": shown})
                fingerprint = checked_fingerprint(asked.fingerprint)
            key = await self._client.pair(address, fingerprint, asked.code)
            known = (each.id for each in self._list if each.address == address)
            entry = SeatEntry(
                next(known, secrets.token_hex(6)), name or address, address, key, fingerprint
            )
            self._list.put(entry)
        except InputError as error:
            raise _conflict(error) from None
        await self._forget(entry.id)
        self._seats[entry.id] = WatchedSeat(entry, self._client, self._notify)
        self._notify()
        return web.json_response({"id": entry.id})

    async def _remove(self, request: web.Request) -> web.Response:
        _check_teacher(request)
        seat = self._entry(request).id
        try:
            self._list.remove(seat)
        except InputError as error:
            raise _conflict(error) from None
        await self._forget(seat)
        self._notify()
        return web.json_response({})

    async def _forget(self, seat: str) -> None:
        self._pins.pop(seat, None)
        watched = self._seats.pop(seat, None)
        if watched is not None:
            await watched.close()

    async def _order(self, request: web.Request) -> web.Response:
        """Have something done at a seat; its PIN is remembered until the board ends."""
        _check_teacher(request)
        entry = self._entry(request)
        asked = await read_body(request, SeatOrder)
        pin = asked.pin or self._pins.get(entry.id, "")
        if not pin:
            return web.json_response({"needsPin": True})
        try:
            await self._client.request(
                entry, "/instructor", OrderRequest(pin, asked.order, asked.text)
            )
        except RefusedError as error:
            self._pins.pop(entry.id, None)
            raise _conflict(error) from None
        except InputError as error:
            raise _conflict(error) from None
        self._pins[entry.id] = pin
        return web.json_response({})


async def _confirm_pairing(_request: web.Request) -> web.Response:
    """Confirm to a browser, which cannot read its cookie, that it has one; else refuse it."""
    return web.json_response({}, headers={hdrs.CACHE_CONTROL: "no-store"})


def _check_teacher(request: web.Request) -> None:
    if request[ROLE].is_watch_only:
        raise web.HTTPForbidden(text=ONLY_TEACHERS)


def _conflict(error: InputError) -> web.HTTPConflict:
    return web.HTTPConflict(text=str(error))
