"""What waits to be sent to one view: every event in order, of all else only the latest."""

from __future__ import annotations

import asyncio
from collections import deque

from rastrainer_simulator.view_server.outgoing import (
    CONTROL,
    PAIRING,
    SCENE,
    SCREEN,
    STATE,
    WELCOME,
)

_BEFORE_EVENTS = (WELCOME, SCENE, CONTROL, SCREEN, PAIRING)


class Outbox:
    """The messages for a view; it belongs to the event loop's thread."""

    def __init__(self, most_events: int) -> None:
        self._most_events = most_events
        self._latest: dict[str, str] = {}
        self._events: deque[str] = deque()
        self._is_filled = asyncio.Event()
        self.is_overfull = False
        """Whether more events have come than may wait."""

    def put_latest(self, kind: str, text: str) -> None:
        """Have a text sent, in place of one of its kind that still waits."""
        self._latest[kind] = text
        self._is_filled.set()

    def put_event(self, text: str) -> None:
        """Have an event sent after those before it."""
        if len(self._events) >= self._most_events:
            self.is_overfull = True
        else:
            self._events.append(text)
        self._is_filled.set()

    async def take(self) -> str:
        """Wait for something to send and return it; what moves comes last."""
        await self._is_filled.wait()
        text = self._next()
        if not self._latest and not self._events:
            self._is_filled.clear()
        return text

    def _next(self) -> str:
        for kind in _BEFORE_EVENTS:
            if kind in self._latest:
                return self._latest.pop(kind)
        if self._events:
            return self._events.popleft()
        return self._latest.pop(STATE)
