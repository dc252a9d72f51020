"""The mouse and the touch pad turn the view: right drag, wheel and pinch."""

from __future__ import annotations

import pygame

from rastrainer_simulator.desktop.connection import ServerConnection
from rastrainer_simulator.net.views.messages import ORBIT

RIGHT_BUTTON = 3
DEG_PER_HEIGHT = 180.0
"""A drag over the window's whole height turns the view by so much."""
ZOOM_PER_NOTCH = 0.9
ZOOM_LIMITS = (0.25, 4.0)
"""In one message; nobody turns the wheel faster."""


class ViewMouse:
    """Adds up the mouse's motion between two pictures, and sends it to the simulator."""

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
