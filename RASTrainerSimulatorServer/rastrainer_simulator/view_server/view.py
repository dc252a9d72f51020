"""One view that has joined: its stream in both directions."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Callable, Mapping
from typing import Any

from aiohttp import WSCloseCode, WSMsgType, web

from rastrainer.errors import InputError
from rastrainer_simulator.rate_limit import RateLimit
from rastrainer_simulator.view_server import messages
from rastrainer_simulator.view_server.held_input import HeldInput
from rastrainer_simulator.view_server.limits import ViewLimits
from rastrainer_simulator.view_server.messages import Received, check_message
from rastrainer_simulator.view_server.operator_desk import Frames, OperatorDesk
from rastrainer_simulator.view_server.outbox import Outbox

_log = logging.getLogger(__name__)

TOO_MANY_MESSAGES = "The view has sent more messages than a trainee's hands can give."
TOO_MANY_EVENTS = "The view has not read its events; it may come back."
NOT_TEXT = "Messages are texts."


class View:
    """A view's WebSocket.

    Attributes:
        number: of the view; none is used twice.
        is_local: whether it is on this computer, as far as the network can tell.
        outbox: what it is going to be told.
        held: what it holds down.
    """

    def __init__(
        self,
        number: int,
        socket: web.WebSocketResponse,
        desk: OperatorDesk,
        limits: ViewLimits,
        is_local: bool = False,
    ) -> None:
        self.number = number
        self.is_local = is_local
        self.outbox = Outbox(limits.waiting_events)
        self.held = HeldInput(number, desk)
        self._socket = socket
        self._desk = desk
        self._rate = RateLimit(limits.messages_per_s, at_once=limits.messages_per_s)
        self._clock = asyncio.get_running_loop().time
        self._last_message = self._clock()
        self._has_told_frames = False
        self._take = self._takers()

    async def serve(self) -> None:
        """Send and receive until either side ends it."""
        sending = asyncio.create_task(self._send())
        try:
            await self._receive()
        except InputError as error:
            _log.warning("View %d is closed: %s", self.number, error)
            await self._close(WSCloseCode.POLICY_VIOLATION, str(error))
        finally:
            sending.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await sending

    def release_if_silent(self, silent_s: float) -> None:
        """Let go of what is held by a view that has not been heard for `silent_s`."""
        if self.held.is_anything_held and self._clock() - self._last_message > silent_s:
            self.held.release()

    def has_fallen_silent(self, lost_s: float) -> bool:
        """Return, once, whether a view that tells its frames has not been heard for `lost_s`."""
        is_silent = self._has_told_frames and self._clock() - self._last_message > lost_s
        if is_silent:
            self._has_told_frames = False
        return is_silent

    async def close(self, message: str) -> None:
        """End it because the simulator ends."""
        await self._close(WSCloseCode.GOING_AWAY, message)

    async def _send(self) -> None:
        with contextlib.suppress(ConnectionError):
            while not self.outbox.is_overfull:
                await self._socket.send_str(await self.outbox.take())
            await self._close(WSCloseCode.TRY_AGAIN_LATER, TOO_MANY_EVENTS)

    async def _receive(self) -> None:
        async for message in self._socket:
            now = self._clock()
            if not self._rate.allows(now):
                raise InputError(TOO_MANY_MESSAGES)
            if message.type is WSMsgType.PING:
                await self._socket.pong(message.data)
            elif message.type is WSMsgType.TEXT:
                self._last_message = now
                self._handle(check_message(message.data))
            elif message.type is not WSMsgType.PONG:
                raise InputError(NOT_TEXT)

    def _handle(self, received: Received) -> None:
        if received.type not in self._take:
            raise InputError(f"A second {received.type} is not expected.")
        self._take[received.type](*received.values)

    def _takers(self) -> Mapping[str, Callable[..., None]]:
        """Return what is done with each message after the first."""
        desk, view = self._desk, self.number

        def to_desk(take: Callable[..., None]) -> Callable[..., None]:
            return lambda *values: take(view, *values)

        def nothing(*_values: Any) -> None:
            """A sign of life needs no more than to have arrived."""

        return {
            messages.KEY: self.held.key,
            messages.PAD: self.held.pad,
            messages.STICKS: self.held.sticks,
            messages.PRESS: to_desk(desk.on_press),
            messages.ITEM: to_desk(desk.on_item),
            messages.TEXT: to_desk(desk.on_text),
            messages.FRAMES: lambda *values: self._take_frames(Frames(*values)),
            messages.VISIBILITY: to_desk(desk.on_visibility),
            messages.ALIVE: nothing,
        }

    def _take_frames(self, frames: Frames) -> None:
        self._has_told_frames = True
        self._desk.on_frames(self.number, frames)

    async def _close(self, code: int, reason: str) -> None:
        # The protocol has room for 123 bytes.
        with contextlib.suppress(ConnectionError):
            await self._socket.close(code=code, message=reason.encode()[:120])
