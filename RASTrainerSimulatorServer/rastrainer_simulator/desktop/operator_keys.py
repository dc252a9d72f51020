"""What is pressed in the window, as messages to the simulator."""

from __future__ import annotations

import time

import pygame

from rastrainer_simulator.desktop.connection import Connection
from rastrainer_simulator.desktop.key_codes import CODES
from rastrainer_simulator.view_server.messages import ALIVE, KEY, VISIBILITY

ALIVE_S = 0.1
LONGEST_TEXT = 16
FOCUS_LOST = frozenset((pygame.WINDOWFOCUSLOST, pygame.WINDOWMINIMIZED))


class OperatorKeys:
    """Tells the simulator which keys are held, for as long as they are."""

    def __init__(self, connection: Connection):
        self._connection = connection
        self._held: set[str] = set()
        self._told = 0.0

    def take(self, event: pygame.event.Event) -> None:
        """Take one of SDL's events."""
        if event.type == pygame.KEYDOWN:
            self._press(CODES.get(event.scancode, ""), event.unicode)
        elif event.type == pygame.KEYUP:
            self._release(CODES.get(event.scancode, ""))
        elif event.type in FOCUS_LOST:
            # Its release will go to another window: the arm must not run on.
            for code in sorted(self._held):
                self._release(code)
        if event.type in (pygame.WINDOWMINIMIZED, pygame.WINDOWRESTORED):
            is_visible = event.type == pygame.WINDOWRESTORED
            self._connection.send(VISIBILITY, isVisible=is_visible)

    def is_held(self, scancode: int) -> bool:
        """Return whether a key, by its SDL scancode, is held."""
        return CODES.get(scancode, "") in self._held

    def keep_alive(self) -> None:
        """Say often enough that what is held is still held."""
        now = time.monotonic()
        if self._held and now - self._told >= ALIVE_S:
            self._connection.send(ALIVE)
            self._told = now

    def tap(self, code: str) -> None:
        """Press and release a key."""
        self._press(code, "")
        self._release(code)

    def _press(self, code: str, text: str) -> None:
        if code:
            self._held.add(code)
            typed = text[:LONGEST_TEXT] if text.isprintable() else ""
            self._connection.send(KEY, code=code, isDown=True, text=typed)

    def _release(self, code: str) -> None:
        if code in self._held:
            self._held.discard(code)
            self._connection.send(KEY, code=code, isDown=False, text="")
