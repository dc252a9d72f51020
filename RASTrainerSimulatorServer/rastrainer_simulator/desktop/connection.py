"""Connect to the simulator, receive its stream, and reconnect whenever the connection is lost.

Unknown parts of a screen are ignored.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
from collections.abc import Callable, Mapping
from typing import Any

import aiohttp

from rastrainer.errors import InputError
from rastrainer.json_checks import decode_finite_json
from rastrainer_simulator.desktop.head_marks import ShownTrace
from rastrainer_simulator.desktop.inbox import Inbox, LoadedScene, SoundEvent, Viewpoint, read_parts
from rastrainer_simulator.desktop.panels.canvas import Thumbnail
from rastrainer_simulator.net.views.incoming import HELLO, LAYOUT, PICTURE, SUBPROTOCOL
from rastrainer_simulator.presentation.screen import (
    DepthRuler,
    ErrorArrow,
    Fact,
    Hint,
    ItemKind,
    Menu,
    MenuItem,
    ScoreTrend,
    Screen,
    ScreenMessage,
    Tone,
    focused_picture,
)
from rastrainer_simulator.vectors import vector

RETRY_S = 1.0
ANSWER_S = 10.0
SILENCE_S = 20.0
STATE_BEGINS = '{"type":"state"'
LARGEST_MESSAGE = 2**20
LARGEST_SCENE = 2**28
LARGEST_PICTURE = 2**22
UNAUTHORIZED = 401

_log = logging.getLogger(__name__)
Json = Mapping[str, Any]


class ServerConnection:
    """One view of one simulator."""

    def __init__(self, url: str, key: str, inbox: Inbox, refresh_hz: float):
        self._url = url.rstrip("/")
        self._key = key
        self._inbox = inbox
        self._refresh_hz = refresh_hz
        self._key_names: Mapping[str, str] = {}
        self._stream: aiohttp.ClientWebSocketResponse | None = None
        self._outgoing: asyncio.Queue[Mapping[str, Any]] = asyncio.Queue()
        self._last_event = 0
        self._told: str | None = None

    def tell_drawn(self, task: str) -> None:
        """Say, once, that the scene of a task is drawn."""
        if task != self._told:
            self._told = task
            self.send(PICTURE, task=task, share=1.0)

    def send(self, message: str, /, **members: Any) -> None:
        if self._stream is not None:
            self._outgoing.put_nowait({"type": message, **members})

    async def run(self) -> None:
        """Stay connected until canceled."""
        headers = {"Authorization": f"Bearer {self._key}"}
        async with aiohttp.ClientSession(headers=headers) as session:
            while True:
                with contextlib.suppress(aiohttp.ClientError, OSError, asyncio.TimeoutError):
                    await self._join(session)
                if not self._inbox.problem:
                    self._tell("window.lost")
                await asyncio.sleep(RETRY_S)

    async def _join(self, session: aiohttp.ClientSession) -> None:
        try:
            stream = await session.ws_connect(
                f"{self._url}/stream",
                protocols=(SUBPROTOCOL,),
                max_msg_size=LARGEST_MESSAGE,
                # The simulator sends 60 times a second; a slow picture is no silence.
                timeout=aiohttp.ClientWSTimeout(ws_receive=SILENCE_S, ws_close=1.0),
            )
        except aiohttp.WSServerHandshakeError as error:
            unknown = error.status == UNAUTHORIZED
            self._tell("window.unknown" if unknown else "window.refused")
            return
        async with stream:
            self._outgoing = asyncio.Queue()
            self._last_event = 0
            self.send_first(stream)
            sending = asyncio.create_task(self._send_all(stream))
            try:
                async for message in stream:
                    if message.type is aiohttp.WSMsgType.TEXT:
                        await self._take(session, message.data)
            finally:
                self._stream = None
                sending.cancel()

    def send_first(self, stream: aiohttp.ClientWebSocketResponse) -> None:
        """Send the hello; messages may be sent from now on."""
        self._stream = stream
        self.send(HELLO, kind="desktop", device="", refreshHz=self._refresh_hz)
        self.name_keys(self._key_names)

    def name_keys(self, key_names: Mapping[str, str]) -> None:
        """Tell what is written on the keys, by their W3C codes, now and to whom it joins later."""
        self._key_names = key_names
        self.send(LAYOUT, keys=dict(key_names))

    async def _send_all(self, stream: aiohttp.ClientWebSocketResponse) -> None:
        with contextlib.suppress(ConnectionError):
            while True:
                await stream.send_str(json.dumps(await self._outgoing.get()))

    async def _take(self, session: aiohttp.ClientSession, text: str) -> None:
        if text.startswith(STATE_BEGINS):
            self._inbox.take_state(text)
            self._inbox.problem = ""
            return
        try:
            message = decode_finite_json(text)
            kind = message["type"]
            if kind == "scene":
                await self._take_scene(session, message)
            elif kind == "screen":
                await self._take_screen(session, message)
            elif kind in _TAKE:
                _TAKE[kind](self, message)
        except (InputError, KeyError, TypeError, ValueError) as error:
            _log.warning("A message of the simulator cannot be used: %s", error)
            return
        self._inbox.touch()

    def _take_control(self, message: Mapping[str, Any]) -> None:
        self._inbox.holder = str(message["holder"])
        self._inbox.has_control = bool(message["isYou"])

    def _take_pairing(self, message: Mapping[str, Any]) -> None:
        addresses = ", ".join(str(address) for address in message["addresses"])
        self._inbox.pairing = str(message["code"]), addresses

    def _take_welcome(self, message: Mapping[str, Any]) -> None:
        self._told = None
        self.send(PICTURE, task="", share=0.0)
        self._inbox.bodies = tuple(message["bodies"])
        self._inbox.trace = ShownTrace()

    def _take_trace(self, message: Mapping[str, Any]) -> None:
        self._inbox.trace = self._inbox.trace.with_update(message)

    def _take_event(self, message: Mapping[str, Any]) -> None:
        number = int(message["number"])
        if number > self._last_event:
            self._last_event = number
            if message["sound"]:
                sound = SoundEvent(str(message["sound"]), float(message.get("volume", 1.0)))
                self._inbox.sounds.append(sound)

    async def _take_screen(
        self, session: aiohttp.ClientSession, message: Mapping[str, Any]
    ) -> None:
        """Show a screen, once the picture of the item that has the focus is there."""
        screen = screen_from_json(message["screen"])
        picture = focused_picture(screen.menu)
        if picture and picture not in self._inbox.thumbnails:
            try:
                content = await self._content(session, picture, LARGEST_PICTURE)
                self._inbox.thumbnails[picture] = Thumbnail.from_png(content)
            except (aiohttp.ClientResponseError, InputError) as error:
                _log.warning("A picture cannot be shown: %s", error)
        self._inbox.screen = screen

    async def _take_scene(self, session: aiohttp.ClientSession, message: Mapping[str, Any]) -> None:
        """Load a scene; the one that is shown stays until the next is there."""
        content = await self._content(session, str(message["url"]), LARGEST_SCENE)
        self._inbox.scene = LoadedScene(
            read_parts(content, self._inbox.bodies),
            {name: Viewpoint.from_json(value) for name, value in message["cameras"].items()},
            {str(label): tuple(place) for label, place in message["fiducials"].items()},
            {str(name): tuple(nodes) for name, nodes in message["noGo"].items()},
            str(message["task"]),
        )

    async def _content(self, session: aiohttp.ClientSession, path: str, most: int) -> bytes:
        async with session.get(self._url + path) as answer:
            answer.raise_for_status()
            content = await answer.content.read(most)
            while not answer.content.at_eof() and len(content) < most:
                content += await answer.content.read(most - len(content))
        return content

    def _tell(self, problem: str) -> None:
        self._inbox.problem = problem
        self._inbox.touch()


_TAKE: Mapping[str, Callable[[ServerConnection, Mapping[str, Any]], None]] = {
    "welcome": ServerConnection._take_welcome,
    "event": ServerConnection._take_event,
    "control": ServerConnection._take_control,
    "pairing": ServerConnection._take_pairing,
    "trace": ServerConnection._take_trace,
}


async def pair(url: str, code: str) -> str:
    """Return a key in exchange for the code that the simulator shows."""
    address = f"{url.rstrip('/')}/pair"
    try:
        async with (
            aiohttp.ClientSession(timeout=aiohttp.ClientTimeout(total=ANSWER_S)) as session,
            session.post(address, json={"code": code}) as answer,
        ):
            if answer.status != 200:
                raise InputError("The pairing code must be the one that the simulator shows now.")
            return str((await answer.json())["key"])
    except (aiohttp.ClientError, OSError, asyncio.TimeoutError) as error:
        raise InputError(f"There must be a simulator at {url}: {error}.") from None


def screen_from_json(value: Json) -> Screen:
    """Return the screen of a `screen` message.

    Raises:
        ValueError, KeyError, TypeError: it is none.
    """
    menu = value["menu"]
    return Screen(
        menu=None if menu is None else _menu(menu),
        instruction=_message(value["instruction"]),
        warnings=tuple(_message(warning) for warning in value["warnings"]),
        status=tuple(str(fact) for fact in value["status"]),
        hints=tuple(
            Hint(str(hint["control"]), str(hint["action"]), str(hint["item"]))
            for hint in value["hints"]
        ),
        language=str(value["language"]),
        is_spoken=bool(value["is_spoken"]),
        has_sticks=bool(value["has_sticks"]),
        has_arrow=bool(value["has_arrow"]),
        errors=tuple(_error(arrow) for arrow in value["errors"]),
        is_head_clear=bool(value["is_head_clear"]),
        coverage=str(value["coverage"]),
        ruler=None if value["ruler"] is None else _ruler(value["ruler"]),
    )


def _ruler(value: Json) -> DepthRuler:
    outer, inner = value["outer"], value["inner"]
    of_entry, of_outer, of_inner, of_target = map(str, value["names"])
    return DepthRuler(
        float(value["entry"]),
        None if outer is None else float(outer),
        None if inner is None else float(inner),
        float(value["target"]),
        (of_entry, of_outer, of_inner, of_target),
    )


def _error(value: Json) -> ErrorArrow:
    begin, end = vector(value["begin"]), vector(value["end"])
    return ErrorArrow(begin, end, Tone(value["tone"]), str(value["name"]))


def _menu(value: Json) -> Menu:
    return Menu(
        name=str(value["name"]),
        title=str(value["title"]),
        paragraphs=tuple(str(text) for text in value["paragraphs"]),
        facts=tuple(
            Fact(str(fact["label"]), str(fact["value"]), Tone(fact["tone"]))
            for fact in value["facts"]
        ),
        items=tuple(_item(item) for item in value["items"]),
        focus=str(value["focus"]),
        picture=str(value["picture"]),
        trend=None if value["trend"] is None else _trend(value["trend"]),
    )


def _trend(value: Json) -> ScoreTrend:
    return ScoreTrend(
        text=str(value["text"]),
        scores=tuple(min(max(float(score), 0.0), 100.0) for score in value["scores"]),
        mark=float(value["mark"]),
    )


def _item(value: Json) -> MenuItem:
    return MenuItem(
        name=str(value["name"]),
        label=str(value["label"]),
        kind=ItemKind(value["kind"]),
        value=str(value["value"]),
        is_enabled=bool(value["is_enabled"]),
        help=str(value["help"]),
        picture=str(value["picture"]),
    )


def _message(value: Json) -> ScreenMessage:
    return ScreenMessage(str(value["text"]), Tone(value["tone"]))
