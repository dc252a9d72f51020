"""The mouse: it turns the view, and drags two sticks for who has nothing else."""

from __future__ import annotations

import math
import time

import pygame

from rastrainer_simulator.desktop.connection import ServerConnection
from rastrainer_simulator.desktop.keyboard import ALIVE_S
from rastrainer_simulator.desktop.panels.stick import stick_boxes
from rastrainer_simulator.net.views.messages import ALIVE, ORBIT, STICKS

LEFT_BUTTON = 1
RIGHT_BUTTON = 3
DEG_PER_HEIGHT = 180.0
"""A drag over the window's whole height turns the view by so much."""
ZOOM_PER_NOTCH = 0.9
ZOOM_LIMITS = (0.25, 4.0)
"""In one message; nobody turns the wheel faster."""
Push = tuple[float, float]
"""Right and up, −1 to 1 each."""


class ViewMouse:
    """Turns the view by right drag, wheel and pinch.

    It adds up the motion between two pictures, and sends it to the simulator.
    """

    def __init__(self, connection: ServerConnection) -> None:
        self._connection = connection
        self._is_dragging = False
        self._around = self._higher = 0.0
        self._zoom = 1.0

    def take(self, event: pygame.event.Event, height: int) -> None:
        """Take one of SDL's events; `height` is the window's, in pixels."""
        if event.type in (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP):
            if event.button == RIGHT_BUTTON:
                self._is_dragging = event.type == pygame.MOUSEBUTTONDOWN
        elif event.type == pygame.MOUSEMOTION and self._is_dragging:
            # What is seen follows the pointer: the eye goes the other way.
            right, down = event.rel
            self._around -= DEG_PER_HEIGHT * right / height
            self._higher += DEG_PER_HEIGHT * down / height
        elif event.type == pygame.MOUSEWHEEL:
            self._zoom *= ZOOM_PER_NOTCH**event.y
        elif event.type == pygame.MULTIGESTURE:
            self._zoom /= max(0.5, 1.0 + 2.0 * event.pinched)
        elif event.type == pygame.WINDOWFOCUSLOST:
            self._is_dragging = False

    def tell(self, is_wanted: bool) -> None:
        """Send what has come together, or forget it."""
        if is_wanted and (self._around, self._higher, self._zoom) != (0.0, 0.0, 1.0):
            nearest, farthest = ZOOM_LIMITS
            self._connection.send(
                ORBIT,
                aroundDeg=min(180.0, max(-180.0, self._around)),
                higherDeg=min(180.0, max(-180.0, self._higher)),
                zoom=min(farthest, max(nearest, self._zoom)),
            )
        self._around = self._higher = 0.0
        self._zoom = 1.0


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
