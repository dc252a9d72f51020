"""Connect to the simulator, receive its stream, and reconnect whenever the connection is lost."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Mapping

import aiohttp

from rastrainer.errors import InputError
from rastrainer_simulator.desktop.head_marks import ShownTrace
from rastrainer_simulator.desktop.inbox import Inbox, LoadedScene, SoundEvent, Viewpoint, read_parts
from rastrainer_simulator.desktop.panels.canvas import Thumbnail
from rastrainer_simulator.presentation.messages import (
    SUBPROTOCOL,
    ControlNews,
    Feedback,
    Hello,
    LayoutInput,
    News,
    PairingNews,
    PictureProgress,
    SceneNews,
    ScreenNews,
    TraceNews,
    ViewInput,
    WelcomeNews,
    message_text,
    read_news,
)
from rastrainer_simulator.presentation.screen import focused_picture

RETRY_S = 1.0
ANSWER_S = 10.0
SILENCE_S = 20.0
STATE_BEGINS = '{"type":"state"'
LARGEST_MESSAGE = 2**20
LARGEST_SCENE = 2**28
LARGEST_PICTURE = 2**22
UNAUTHORIZED = 401

_log = logging.getLogger(__name__)


class ServerConnection:
    """One view of one simulator."""

    def __init__(self, url: str, key: str, inbox: Inbox, refresh_hz: float):
        self._url = url.rstrip("/")
        self._key = key
        self._inbox = inbox
        self._refresh_hz = refresh_hz
        self._key_names: Mapping[str, str] = {}
        self._stream: aiohttp.ClientWebSocketResponse | None = None
        self._outgoing: asyncio.Queue[ViewInput] = asyncio.Queue()
        self._last_event = 0
        self._told: str | None = None

    def tell_drawn(self, task: str) -> None:
        """Say, once, that the scene of a task is drawn."""
        if task != self._told:
            self._told = task
            self.send(PictureProgress(task, 1.0))

    def send(self, message: ViewInput) -> None:
        if self._stream is not None:
            self._outgoing.put_nowait(message)

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
        self.send(Hello("desktop", refresh_hz=self._refresh_hz))
        self.name_keys(self._key_names)

    def name_keys(self, key_names: Mapping[str, str]) -> None:
        """Tell what is written on the keys, by their W3C codes, now and to whom it joins later."""
        self._key_names = key_names
        self.send(LayoutInput(key_names))

    async def _send_all(self, stream: aiohttp.ClientWebSocketResponse) -> None:
        with contextlib.suppress(ConnectionError):
            while True:
                await stream.send_str(message_text(await self._outgoing.get()))

    async def _take(self, session: aiohttp.ClientSession, text: str) -> None:
        if text.startswith(STATE_BEGINS):
            self._inbox.take_state(text)
            self._inbox.problem = ""
            return
        try:
            news = read_news(text)
            if isinstance(news, SceneNews):
                await self._take_scene(session, news)
            elif isinstance(news, ScreenNews):
                await self._take_screen(session, news)
            else:
                self._take_news(news)
        except InputError as error:
            _log.warning("A message of the simulator cannot be used: %s", error)
            return
        self._inbox.touch()

    def _take_news(self, news: News | None) -> None:
        inbox = self._inbox
        if isinstance(news, ControlNews):
            inbox.holder, inbox.has_control = news.holder, news.is_you
        elif isinstance(news, PairingNews):
            inbox.pairing = news.code, ", ".join(news.addresses)
        elif isinstance(news, TraceNews):
            inbox.trace = inbox.trace.with_update(news)
        elif isinstance(news, WelcomeNews):
            self._told = None
            self.send(PictureProgress("", 0.0))
            inbox.bodies, inbox.trace = news.bodies, ShownTrace()
        elif isinstance(news, Feedback) and news.number > self._last_event:
            self._last_event = news.number
            if news.sound:
                inbox.sounds.append(SoundEvent(news.sound, news.volume))

    async def _take_screen(self, session: aiohttp.ClientSession, news: ScreenNews) -> None:
        """Show a screen, once the picture of the item that has the focus is there."""
        picture = focused_picture(news.screen.menu)
        if picture and picture not in self._inbox.thumbnails:
            try:
                content = await self._content(session, picture, LARGEST_PICTURE)
                self._inbox.thumbnails[picture] = Thumbnail.from_png(content)
            except (aiohttp.ClientResponseError, InputError) as error:
                _log.warning("A picture cannot be shown: %s", error)
        self._inbox.screen = news.screen

    async def _take_scene(self, session: aiohttp.ClientSession, news: SceneNews) -> None:
        """Load a scene; the one that is shown stays until the next is there."""
        content = await self._content(session, news.url, LARGEST_SCENE)
        self._inbox.scene = LoadedScene(
            read_parts(content, self._inbox.bodies),
            {name: Viewpoint.of(camera) for name, camera in news.cameras.items()},
            news.fiducials,
            news.no_go,
            news.task,
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
