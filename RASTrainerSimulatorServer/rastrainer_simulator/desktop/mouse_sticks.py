"""Two sticks in the window that the mouse drags, for who has nothing else."""

from __future__ import annotations

import math
import time

import pygame

from rastrainer_simulator.desktop.connection import ServerConnection
from rastrainer_simulator.desktop.keyboard import ALIVE_S
from rastrainer_simulator.desktop.panels.stick import stick_boxes
from rastrainer_simulator.net.views.messages import ALIVE, STICKS

LEFT_BUTTON = 1
Push = tuple[float, float]
"""Right and up, −1 to 1 each."""


class MouseSticks:
    """Sends how the sticks stand, and lets go of them when the button or the window does.

    Attributes:
        pushes: how the left and the right stick stand.
    """

    def __init__(self, connection: ServerConnection) -> None:
        self.pushes: tuple[Push, Push] = ((0.0, 0.0), (0.0, 0.0))
        self._connection = connection
        self._dragged: int | None = None
        self._told = 0.0

    def take(self, event: pygame.event.Event, size: tuple[int, int]) -> bool:
        """Take one of SDL's events while the sticks are shown; return whether it was for them.

        `size` is the window's, in pixels.
        """
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == LEFT_BUTTON:
            for index, box in enumerate(stick_boxes(size)):
                x, y = event.pos[0] - box.left, event.pos[1] - box.top
                if math.hypot(2 * x / box.width - 1, 2 * y / box.height - 1) <= 1.0:
                    self._dragged = index
                    self._push(event.pos, size)
                    return True
        elif event.type == pygame.MOUSEMOTION and self._dragged is not None:
            self._push(event.pos, size)
        elif (event.type == pygame.MOUSEBUTTONUP and event.button == LEFT_BUTTON) or (
            event.type == pygame.WINDOWFOCUSLOST
        ):
            self.release()
        return False

    def release(self) -> None:
        """Let both sticks go."""
        self._dragged = None
        self._tell(((0.0, 0.0), (0.0, 0.0)))

    def keep_alive(self) -> None:
        """Say often enough that what is held is still held."""
        now = time.monotonic()
        if any(map(any, self.pushes)) and now - self._told >= ALIVE_S:
            self._connection.send(ALIVE)
            self._told = now

    def _push(self, place: tuple[int, int], size: tuple[int, int]) -> None:
        assert self._dragged is not None
        box = stick_boxes(size)[self._dragged]
        x = 2.0 * (place[0] - box.left) / box.width - 1.0
        y = 1.0 - 2.0 * (place[1] - box.top) / box.height
        far = max(1.0, math.hypot(x, y))
        push = (x / far, y / far)
        self._tell((push, (0.0, 0.0)) if self._dragged == 0 else ((0.0, 0.0), push))

    def _tell(self, pushes: tuple[Push, Push]) -> None:
        if pushes == self.pushes:
            return
        self.pushes = pushes
        (right, forward), (turn, up) = pushes
        self._connection.send(
            STICKS, translation=[right, forward, up], rotation=[turn, 0.0], fine=False, yawDeg=0.0
        )
