"""The teacher's board: a page of live tiles, the seats' scenes, and orders to the seats."""

from __future__ import annotations

import asyncio
import contextlib
import json
import secrets
from collections.abc import Callable
from pathlib import Path
from typing import Any

from aiohttp import hdrs, web

from rastrainer.commands import decode_json_object
from rastrainer.errors import InputError
from rastrainer.json_checks import accepted, one_of, text
from rastrainer.study.database.database import StudyPlace
from rastrainer_simulator.assets import NOT_BUILT, page_folder
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
from rastrainer_simulator.net.limits import ViewLimits
from rastrainer_simulator.net.views.access_control import ROLE, PairingCode, Sessions, ViewRole
from rastrainer_simulator.net.views.limited_server import GuardedServer
from rastrainer_simulator.presentation.presenter import InstructorOrder

SUBPROTOCOL = "rastrainer.board.1"
TILES_S = 0.25
"""Between two messages to a teacher's page."""
HEARTBEAT_S = 20.0
MOST_TEACHERS = 16
BODY_S = 5.0
ONLY_TEACHERS = "This browser only watches the board: pair it with the board again."
_order_name = one_of(*(order.value for order in InstructorOrder))


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
        limits: ViewLimits | None = None,
        study: StudyPlace | None = None,
    ) -> None:
        """Watch the seats that the folder of settings lists; in the event loop's thread.

        Args:
            config: Folder of settings.
            client: Talks to the seats.
            on_new_code: Called with each new code for browsers.
            limits: What connections may cost.
            study: Whose trainees are the class; None for a board of seats alone.
        """
        self._client = client
        self._list = SeatList(config)
        self._changed = asyncio.Event()
        self._pages: set[asyncio.Event] = set()
        self._seats = {entry.id: self._watched(entry) for entry in self._list}
        self._pins: dict[str, str] = {}
        self._class = ClassWatch(study)
        self._page = page_folder()
        sessions = Sessions(dict.fromkeys(ViewRole, MOST_TEACHERS))
        self.code = PairingCode(asyncio.get_running_loop().time, on_new_code)
        self._http = GuardedServer(
            sessions, self.code, limits or ViewLimits(), self._routes(), self._page
        )

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

    def _routes(self) -> list[web.RouteDef]:
        live = LiveView(self._entry, self._client)
        return [
            web.get("/", self._send_page),
            web.get("/tiles", self._send_tiles),
            web.get("/class", self._class.send),
            web.get("/paired", _confirm_pairing),
            web.post("/seats", self._add),
            web.delete(SEAT_PATH, self._remove),
            web.post(f"{SEAT_PATH}/order", self._order),
            *live.routes(),
        ]

    def _watched(self, entry: SeatEntry) -> WatchedSeat:
        return WatchedSeat(entry, self._client, self._notify)

    def _notify(self) -> None:
        for page in self._pages:
            page.set()

    def _seat(self, request: web.Request) -> WatchedSeat:
        seat = self._seats.get(request.match_info["seat"])
        if seat is None:
            raise web.HTTPNotFound(text="There is no such seat on this board.")
        return seat

    def _entry(self, request: web.Request) -> SeatEntry:
        return self._seat(request).entry

    async def _send_page(self, _request: web.Request) -> web.StreamResponse:
        if self._page is None:
            return web.Response(text=NOT_BUILT, content_type="text/html")
        return web.FileResponse(self._page / "board.html")

    async def _send_tiles(self, request: web.Request) -> web.StreamResponse:
        socket = web.WebSocketResponse(
            protocols=(SUBPROTOCOL,), max_msg_size=1024, heartbeat=HEARTBEAT_S, writer_limit=0
        )
        if socket.can_prepare(request).protocol != SUBPROTOCOL:
            raise web.HTTPBadRequest(text=f"Ask for a WebSocket with {SUBPROTOCOL}.")
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
                tiles = [seat.tile() for seat in self._seats.values()]
                await socket.send_str(json.dumps({"type": "tiles", "seats": tiles}))
                await asyncio.sleep(TILES_S)

    async def _add(self, request: web.Request) -> web.Response:
        """Pair with a simulator. Without its fingerprint, return it for comparison."""
        _check_teacher(request)
        values = await _body(request)
        try:
            name = accepted(text(40), values.get("name"), "The name").strip()
            address = checked_address(accepted(text(300), values.get("address"), "The address"))
            shown = str(values.get("fingerprint", ""))
            if address.startswith("https:") and not shown:
                shown = await self._client.fingerprint(address)
                return web.json_response({"fingerprint": shown})
            fingerprint = checked_fingerprint(shown) if address.startswith("https:") else ""
            code = accepted(text(12), values.get("code"), "The pairing code")
            key = await self._client.pair(address, fingerprint, code)
            known = (each.id for each in self._list if each.address == address)
            entry = SeatEntry(
                next(known, secrets.token_hex(6)), name or address, address, key, fingerprint
            )
            self._list.put(entry)
        except InputError as error:
            raise _conflict(error) from None
        await self._forget(entry.id)
        self._seats[entry.id] = self._watched(entry)
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
        values = await _body(request)
        try:
            order = InstructorOrder(accepted(_order_name, values.get("order"), "The order"))
            sentence = str(values.get("text", ""))
            pin = str(values.get("pin", "")) or self._pins.get(entry.id, "")
            if not pin:
                return web.json_response({"needsPin": True})
            await self._client.order(entry, order, sentence, pin)
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


async def _body(request: web.Request) -> dict[str, Any]:
    try:
        return decode_json_object((await asyncio.wait_for(request.read(), BODY_S)).decode())
    except (InputError, ValueError, asyncio.TimeoutError, ConnectionError):
        raise web.HTTPBadRequest(text="Send one JSON object.") from None
