"""The mouse: where it points, as long as somebody moves it."""

from __future__ import annotations

import pygame

REST_S = 3.0
NOWHERE = (-1, -1)


class Pointer:
    """Hides the pointer when it rests, so that it marks nothing for those who use a gamepad."""

    def __init__(self) -> None:
        self._place = NOWHERE
        self._moved = -REST_S
        self._is_visible = True

    def move(self, place: tuple[int, int], now: float) -> None:
        """Somebody moved it, or clicked, at `now` (s)."""
        self._place, self._moved = place, now

    def place(self, now: float) -> tuple[int, int]:
        """Return where it points, in pixels from the upper left; NOWHERE while it rests."""
        is_visible = now - self._moved < REST_S
        if is_visible != self._is_visible:
            self._is_visible = is_visible
            pygame.mouse.set_visible(is_visible)
        return self._place if is_visible else NOWHERE
