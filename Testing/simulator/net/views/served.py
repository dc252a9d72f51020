"""A view server on a real socket with a real control loop, and views that join it."""

from __future__ import annotations

import asyncio
import json
from contextlib import suppress
from pathlib import Path

import aiohttp

from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.loop.results import Subscribers
from rastrainer_simulator.net.limits import ViewLimits
from rastrainer_simulator.net.views.view_server import ViewServer
from rastrainer_simulator.ops.instructor_pin import InstructorPin
from rastrainer_simulator.presentation.messages import Seat, ViewRole
from rastrainer_simulator.presentation.presenter import Control, TraceGuidance
from rastrainer_simulator.presentation.screen import Screen
from rastrainer_simulator.viewpoint.view_control import CameraPose, Pictures
from Testing.free_port import free_port
from Testing.simulator.net.igtl.servers import HOST, PATIENCE_S, LoopThread

SUBPROTOCOL = "rastrainer.views.1"
HELLO = {"type": "hello", "kind": "page", "device": "Quest 2", "refreshHz": 72}
LOOKED_FROM = CameraPose((0.5, -0.5, 0.4), (0.5, 0.0, 0.25), (0.0, 0.0, 1.0), 30.0)


class RecordingPresenter:
    """A `Presenter` that records its calls, and sends what a test wants."""

    def __init__(self):
        self.screen = Screen()
        self.control = Control()
        self.guidance = TraceGuidance()
        self.reported_seat = Seat()
        self.problem = ""
        self.calls = []
        self.updates = Subscribers()

    def pictures(self, _now):
        """Look through a camera that no scenario has, without an inset."""
        return Pictures(LOOKED_FROM)

    def ghost(self, _now):
        """Show no ghost."""

    def trace_guidance(self, _now):
        return self.guidance

    def seat(self):
        return self.reported_seat

    def instruct(self, order, text):
        """Record a teacher's order, and carry it out unless there is a `problem`."""
        self.calls.append(("instruct", order.value, text))
        return self.problem

    def tell(self, *news):
        for one in news:
            self.updates.publish(one)

    def receive(self, view, kind, *values):
        self.calls.append((f"on_{kind}", view, *values))

    def __getattr__(self, name):
        if not name.startswith("view_"):
            raise AttributeError(name)
        return lambda *values: self.calls.append((name, *values))


class ServedViews:
    """A `ViewServer` in its own event loop.

    Attributes:
        presenter: where the views' input ends.
        url: of the server.
        new_codes: the pairing codes that were to be shown after the first.
        pictures: files of the scenarios' pictures by the scenarios' names.
        pin: of the seat; None without a folder of settings.
    """

    def __init__(
        self,
        thread: LoopThread,
        control_loop: ControlLoop,
        port: int = 0,
        config: Path | None = None,
        **limits,
    ):
        self.thread = thread
        self.presenter = RecordingPresenter()
        self.new_codes = []
        self.pictures = {}
        self.pin = None if config is None else InstructorPin(config)
        self._is_closed = False
        self.server = thread.call(
            ViewServer,
            control_loop,
            self.presenter,
            self._note_code,
            limits=ViewLimits(**limits),
            scenario_picture=self.pictures.get,
            config=config,
            pin=self.pin,
        )
        self.port = thread.run(self.server.listen(HOST, port or free_port()))
        self.url = f"http://{HOST}:{self.port}"

    def _note_code(self, said: str) -> None:
        self.new_codes.append(said.removeprefix("has a new pairing code for views: "))

    @property
    def code(self) -> str:
        return self.server.code.code

    def new_key(self, role: ViewRole = ViewRole.VIEW) -> str:
        return self.thread.call(self.server.sessions.open, role)

    def tell(self, *news):
        """Have the presenter send several things at once."""
        self.thread.call(self.presenter.tell, *news)

    def wait_for_call(self, *call):
        """Wait for a call of the presenter; return all calls."""

        async def wait():
            while call not in self.presenter.calls:
                await asyncio.sleep(0.005)

        self.thread.run(wait())
        return self.presenter.calls

    def close(self):
        """End the server; a second time does nothing."""
        if not self._is_closed:
            self._is_closed = True
            self.thread.run(self.server.close())


class ViewClient:
    """One view, for tests that block; it takes any certificate."""

    def __init__(self, thread: LoopThread, url: str, key: str):
        self._thread = thread
        self._session = thread.run(_session())
        headers = {"Authorization": f"Bearer {key}"}
        connecting = self._session.ws_connect(
            f"{url}/stream", protocols=[SUBPROTOCOL], headers=headers, ssl=False
        )
        try:
            self._socket = self._run(connecting)
        except aiohttp.ClientError:
            self.__exit__()
            raise

    def __enter__(self) -> ViewClient:
        return self

    def __exit__(self, *_exception):
        self._run(self._session.close())

    def join(self, **changes) -> dict:
        """Say hello and return the welcome."""
        self.send({**HELLO, **changes})
        return self.next()

    def send(self, message):
        """Send an object as JSON, a text or bytes as they are."""
        if isinstance(message, bytes):
            self._run(self._socket.send_bytes(message))
        else:
            text = message if isinstance(message, str) else json.dumps(message)
            self._run(self._socket.send_str(text))

    def ping(self):
        """Send a ping; its answer is not returned."""
        self._run(self._socket.ping())

    def next(self, kind: str | None = None) -> dict:
        """Return the next message, or the next of a kind."""
        while True:
            decoded = json.loads(self.next_text())
            if kind in (None, decoded["type"]):
                return decoded

    def next_text(self) -> str:
        """Return the next message as it came."""
        message = self._receive()
        assert message.type is aiohttp.WSMsgType.TEXT, message
        return message.data

    def all_until(self, is_last) -> list[dict]:
        """Return the messages up to the first for which `is_last` is true."""
        messages = []
        while not messages or not is_last(messages[-1]):
            messages.append(self.next())
        return messages

    def closing(self) -> tuple[int, str]:
        """Read on until the server closes; return its code and its reason."""
        while (message := self._receive()).type is aiohttp.WSMsgType.TEXT:
            pass
        assert message.type is aiohttp.WSMsgType.CLOSE, message
        return message.data, message.extra

    def leave(self):
        self._run(self._socket.close())

    def _receive(self):
        return self._run(self._socket.receive())

    def _run(self, coroutine):
        return self._thread.run(coroutine)


async def _session() -> aiohttp.ClientSession:
    return aiohttp.ClientSession()


def request(url: str, path: str, method: str = "GET", **arguments) -> tuple[int, dict, bytes]:
    """Return status, headers and body of one request."""
    return asyncio.run(answered(url, path, method, **arguments))


async def answered(url: str, path: str, method: str = "GET", **arguments) -> tuple:
    """Return status, headers and body of one request, in a running event loop."""
    async with (
        aiohttp.ClientSession(cookie_jar=aiohttp.DummyCookieJar()) as session,
        session.request(method, url + path, **arguments) as response,
    ):
        return response.status, response.headers, await response.read()


def raw_request(port: int, head: str) -> bytes:
    """Send a request as it is written, with no client to clean it; return the whole answer."""

    async def ask():
        reader, writer = await asyncio.open_connection(HOST, port)
        writer.write(f"{head}\r\nHost: {HOST}:{port}\r\nConnection: close\r\n\r\n".encode())
        answer = await asyncio.wait_for(reader.read(), PATIENCE_S)
        writer.close()
        with suppress(ConnectionError):
            await writer.wait_closed()
        return answer

    return asyncio.run(ask())
