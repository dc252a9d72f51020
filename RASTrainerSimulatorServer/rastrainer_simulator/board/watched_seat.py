"""One watched simulator: the state of its seat, and its scene in a teacher's browser.

The browser sees the scene by way of the board, which has the key. The page and its code are the
board's own; only the scene, sounds, pictures and what moves come from the simulator.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import Callable, Mapping
from enum import Enum
from typing import Any

import aiohttp
from aiohttp import WSMsgType, hdrs, web

from rastrainer.errors import InputError
from rastrainer.json_checks import (
    accepted,
    decode_message_object,
    number,
    one_of,
    text,
    whole_number,
    yes_or_no,
)
from rastrainer.protocol import Phase
from rastrainer_simulator.assets import NOT_BUILT, page_folder
from rastrainer_simulator.board.seats import (
    OtherCertificateError,
    RefusedError,
    SeatClient,
    SeatEntry,
    UnpairedError,
)
from rastrainer_simulator.net.views.access_control import ViewRole
from rastrainer_simulator.net.views.incoming import (
    BOARD,
    HELLO,
    SPECTATOR,
    SUBPROTOCOL,
    check_message,
)
from rastrainer_simulator.net.views.outgoing import SEAT
from rastrainer_simulator.state import TouchStage
from rastrainer_simulator.texts.texts import NARROW_SPACE, NO_BREAK_SPACE

RETRY_S = 2.0
MOST_WARNINGS = 8
_BOARD_HELLO = json.dumps({"type": HELLO, "kind": BOARD, "device": "", "refreshHz": 0})
_SPACES = str.maketrans({NARROW_SPACE: " ", NO_BREAK_SPACE: " "})
"""French and Chinese texts have spaces that count as not printable."""


def _words(longest: int) -> Callable[[Any], str]:
    """Accept text of a simulator in any language."""
    check = text(longest, min_length=0)

    def checked(value: Any) -> str:
        check(value.translate(_SPACES) if isinstance(value, str) else value)
        return str(value)

    return checked


_sentence, _short = _words(600), _words(200)


def _sentences(value: Any) -> list[str]:
    """Accept a few sentences."""
    if not isinstance(value, list):
        raise ValueError("a list of sentences")
    return [_sentence(each) for each in value[:MOST_WARNINGS]]


def _score(value: Any) -> float | None:
    """Accept 0 to 100, or null."""
    return None if value is None else number(0, 100)(value)


MEMBERS: Mapping[str, Callable[[Any], Any]] = {
    "trainee": _short,
    "task": _short,
    "count": whole_number(0, 1000),
    "screen": _short,
    "instruction": _sentence,
    "warnings": _sentences,
    "score": _score,
    "holder": _short,
    "slicer": yes_or_no,
    "language": text(12),
    "assignments": _sentence,
    "phase": one_of(*(phase.value for phase in Phase)),
    "touched": whole_number(0, 1000),
    "rejected": whole_number(0, 1_000_000),
    "elapsed": whole_number(0, 10_000_000),
    "touch": one_of(*(stage.value for stage in TouchStage)),
}
"""What a simulator reports about its seat, and how each member is checked."""


class SeatLink(str, Enum):
    """State of the connection to a seat."""

    CONNECTING = "connecting"
    WATCHING = "watching"
    AWAY = "away"
    UNPAIRED = "unpaired"
    OTHER_CERTIFICATE = "other certificate"


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
        self._seat: dict[str, Any] | None = None
        self._task = asyncio.create_task(self._watch())

    def tile(self) -> dict[str, Any]:
        """Return what a board shows of it, ready for JSON; `seat` is None if unreachable."""
        entry = self.entry
        return {
            "id": entry.id,
            "name": entry.name,
            "address": entry.address,
            "link": self._link.value,
            "seat": self._seat,
        }

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
                if values.get("type") == SEAT:
                    self._become(SeatLink.WATCHING, checked_seat(values))
        finally:
            await stream.close()

    def _become(self, link: SeatLink, seat: dict[str, Any] | None = None) -> None:
        if (link, seat) != (self._link, self._seat):
            self._link, self._seat = link, seat
            self._changed()


def checked_seat(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a simulator reports about its seat; further members are ignored."""
    missing = MEMBERS.keys() - values.keys()
    if missing:
        raise InputError(f"What a simulator says of its seat lacks {', '.join(sorted(missing))}.")
    return {
        name: accepted(check, values[name], f"The seat's {name}") for name, check in MEMBERS.items()
    }


SEAT_PATH = "/seat/{seat:[0-9a-f]{12}}"
FILES = {
    "/scene/{name:[0-9a-f]{64}}.glb": "model/gltf-binary",
    "/sounds/{name:[a-z-]{1,32}}.wav": "audio/wav",
    "/scenarios/{name:[a-z0-9-]{1,40}}.png": "image/png",
}
"""What a page may request of a simulator, and its type, whatever the simulator says."""
_KEPT_HEADERS = (hdrs.CONTENT_ENCODING, hdrs.CACHE_CONTROL, hdrs.VARY, "X-File-Size")
_SPECTATOR_HELLO = json.dumps({"type": HELLO, "kind": SPECTATOR, "device": "", "refreshHz": 0})
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
        if self._page is None:
            return web.Response(text=NOT_BUILT, content_type="text/html")
        return web.FileResponse(self._page / "index.html")

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
                content, found = await self._client.file(entry, path)
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
            hello = check_message(first.data)
            if hello.type == HELLO and hello.values[0] == SPECTATOR:
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
