"""One view's WebSocket: outgoing messages, and the inputs that it holds down."""

from __future__ import annotations

import asyncio
import contextlib
import dataclasses
import logging
from collections import deque
from functools import partial
from typing import Any

from aiohttp import WSCloseCode, WSMsgType, web

from rastrainer.errors import InputError
from rastrainer_simulator.loop.timing import RateLimit
from rastrainer_simulator.presentation.messages import (
    WATCHING_KINDS,
    Alive,
    ControlNews,
    Frames,
    HeadsetInput,
    HeadsetPose,
    Hello,
    KeyInput,
    PadInput,
    PairingNews,
    SceneNews,
    ScreenNews,
    SeatNews,
    StateNews,
    SticksInput,
    ViewInput,
    WelcomeNews,
    read_view_input,
)
from rastrainer_simulator.presentation.presenter import Presenter

_log = logging.getLogger(__name__)

TOO_MANY_MESSAGES = "The view has sent more messages than a trainee's inputs can produce."
TOO_MANY_EVENTS = "The view has not read its events; it may come back."
NOT_TEXT = "Messages must be text."
ONLY_WATCHES = f"A spectator drives nothing: it may send {Alive.type} and nothing else."
MESSAGES_PER_S = 500.0
"""That a view may send on average, and at most that many at once."""
MAX_HELD = 32
"""Keys, pads and sticks that one view holds at a time; further keys are ignored."""
SHIFT_KEYS = frozenset(("ShiftLeft", "ShiftRight"))
"""Held with others: the slow motion, by default."""
MAX_WAITING_EVENTS = 256
"""For a view; one more drops it."""
CLOSE_S = 3.0
"""How long a view has to read its pending messages, and to confirm the end."""
_BEFORE_EVENTS = tuple(
    each.type for each in (WelcomeNews, SceneNews, ControlNews, ScreenNews, PairingNews, SeatNews)
)


class ViewSocket:
    """A view's WebSocket; no number is used twice, and a headset that nobody wears has no pose."""

    def __init__(
        self,
        number: int,
        socket: web.WebSocketResponse,
        hello: Hello,
        presenter: Presenter,
        is_local: bool,
    ) -> None:
        self.number = number
        self.hello = hello
        self.is_local = is_local
        self.is_spectator = hello.kind in WATCHING_KINDS
        """Whether it only watches: the flow, which counts who sees a trial, never hears of it."""
        self.outbox = Outbox()
        self.held = HeldInput(number, presenter)
        self.headset_pose: HeadsetPose | None = None
        self._socket = socket
        self._presenter = presenter
        self._rate = RateLimit(MESSAGES_PER_S, at_once=MESSAGES_PER_S)
        self._clock = asyncio.get_running_loop().time
        self._last_message = self._clock()
        self._has_reported_frames = False

    async def serve(self) -> None:
        sending = asyncio.create_task(self._send())
        try:
            await self._receive()
        except InputError as error:
            _log.warning("View %d is closed: %s", self.number, error)
            await self.close(WSCloseCode.POLICY_VIOLATION, str(error))
        finally:
            sending.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await sending

    def check_silence(self, silent_s: float, lost_s: float) -> None:
        """Release the inputs of a view that has not been heard for `silent_s`.

        Report, once, a view that reported its frames and has not been heard for `lost_s`.
        """
        silence_s = self._clock() - self._last_message
        if silence_s > silent_s:
            self.held.release(is_silent=True)
        if silence_s > lost_s and self._has_reported_frames:
            self._has_reported_frames = False
            self._presenter.receive(self.number, "silence")

    async def _send(self) -> None:
        with contextlib.suppress(ConnectionError):
            while not self.outbox.is_overfull:
                await self._socket.send_str(await self.outbox.take())
            await self.close(WSCloseCode.TRY_AGAIN_LATER, TOO_MANY_EVENTS)

    async def _receive(self) -> None:
        async for message in self._socket:
            now = self._clock()
            if not self._rate.allows(now):
                raise InputError(TOO_MANY_MESSAGES)
            if message.type is WSMsgType.PING:
                await self._socket.pong(message.data)
            elif message.type is WSMsgType.TEXT:
                self._last_message = now
                self._handle(read_view_input(message.data))
            elif message.type is not WSMsgType.PONG:
                raise InputError(NOT_TEXT)

    def _handle(self, message: ViewInput) -> None:
        """Process a message after the first; a sign of life only has to arrive."""
        values = [getattr(message, each.name) for each in dataclasses.fields(message)]
        if isinstance(message, Alive):
            return
        if self.is_spectator:
            raise InputError(ONLY_WATCHES)
        if isinstance(message, (KeyInput, PadInput, SticksInput)):
            self.held.take(message.type, *values)
        elif isinstance(message, HeadsetInput) and self.hello.kind == "headset":
            self.headset_pose = message if message.eyes is not None else None
        elif isinstance(message, (HeadsetInput, Hello)):
            raise InputError(f"A {self.hello.kind} sends no {message.type} after its hello.")
        else:
            self._has_reported_frames |= isinstance(message, Frames)
            self._presenter.receive(self.number, message.type, *values)

    async def close(self, code: int, reason: str) -> None:
        """End it, with a code of WebSockets and a reason."""
        # The protocol has room for 123 bytes.
        closing = self._socket.close(code=code, message=reason.encode()[:120])
        with contextlib.suppress(ConnectionError, asyncio.TimeoutError):
            # A peer that no longer reads would hold it up forever.
            await asyncio.wait_for(closing, CLOSE_S)


class HeldInput:
    """Passes a view's keys, pads and sticks on to the presenter and can release them all."""

    def __init__(self, view: int, presenter: Presenter) -> None:
        self._receive = partial(presenter.receive, view)
        self._held_in_silence: set[str] = set()
        # What each held key, a pad or sticks send once they are let go, by kind and key.
        self._released: dict[tuple[str, str], tuple[Any, ...]] = {}

    def take(self, kind: str, *values: Any) -> None:
        """Process a message of a pad, of sticks, or of a key.

        No hand holds more than a few keys, so further keys are ignored. A Shift key that was down
        when the view fell silent, and has not come up since, stays held: the next key must not
        move the arm fast because a computer draws slowly.
        """
        if kind == KeyInput.type:
            code, is_held, _text = values
            self._held_in_silence.discard(code)
            if is_held and self._held_in_silence:
                self.take(kind, self._held_in_silence.pop(), True, "")
            released: tuple[Any, ...] = code, False, ""
            if is_held and (kind, code) not in self._released and len(self._released) >= MAX_HELD:
                return
        else:
            code = ""
            # The angle at which a headset looks holds nothing.
            is_held = any(any(each) if isinstance(each, tuple) else each for each in values[:3])
            zeros = (((0.0,) * len(x) if isinstance(x, tuple) else type(x)()) for x in values)
            released = tuple(zeros)
        self._released.pop((kind, code), None)
        if is_held:
            self._released[kind, code] = released
        self._receive(kind, *values)

    def release(self, is_silent: bool = False) -> None:
        """Release everything that is held, since the view has left or is silent."""
        if not self._released:
            return
        held = {code for kind, code in self._released if kind == KeyInput.type}
        for (kind, _code), values in tuple(self._released.items()):
            self.take(kind, *values)
        self._held_in_silence = held & SHIFT_KEYS if is_silent else set()


class Outbox:
    """The messages for a view; it belongs to the event loop's thread."""

    def __init__(self) -> None:
        self._latest: dict[str, str] = {}
        self._events: deque[str] = deque()
        self._is_filled = asyncio.Event()
        self.is_overfull = False
        """Whether more events are waiting than allowed."""

    def put_latest(self, kind: str, text: str) -> None:
        """Have a text sent, in place of one of its kind that is still waiting."""
        self._latest[kind] = text
        self._is_filled.set()

    def put_event(self, text: str) -> None:
        if len(self._events) >= MAX_WAITING_EVENTS:
            self.is_overfull = True
        else:
            self._events.append(text)
        self._is_filled.set()

    async def take(self) -> str:
        """Wait for something to send and return it; what moves comes last."""
        await self._is_filled.wait()
        first = next((kind for kind in _BEFORE_EVENTS if kind in self._latest), None)
        if first is None and self._events:
            text = self._events.popleft()
        else:
            text = self._latest.pop(first or StateNews.type)
        if not self._latest and not self._events:
            self._is_filled.clear()
        return text
