"""Start SDL for gamepads alone: no window, no sound, no signal handlers."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

from rastrainer.errors import RASTrainerError

_HINTS = {
    "PYGAME_HIDE_SUPPORT_PROMPT": "1",
    "SDL_VIDEODRIVER": "dummy",
    "SDL_NO_SIGNAL_HANDLERS": "1",
    "SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS": "1",
}
"""Events come though no window of ours has the focus, and Ctrl-C stays the server's."""


class NoGamepadsError(RASTrainerError):
    """This computer cannot read gamepads; the sentence says why."""


def start_sdl() -> tuple[ModuleType, ModuleType]:
    """Return pygame and its module of game controllers, both ready.

    Raises:
        NoGamepadsError: pygame is not installed, or SDL does not start.
    """
    with _environment(_HINTS):
        try:
            import pygame
            from pygame._sdl2 import controller
        except ImportError as error:
            raise NoGamepadsError(f"pygame-ce cannot be loaded: {error}") from None
        try:
            pygame.display.init()
            controller.init()
        except pygame.error as error:
            raise NoGamepadsError(f"SDL does not start: {error}") from None
    # Only the coming and going of devices is news; positions are asked for.
    pygame.event.set_blocked(None)
    pygame.event.set_allowed((pygame.JOYDEVICEADDED, pygame.JOYDEVICEREMOVED))
    return pygame, controller


@contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    """Set variables for a while: the windows that the server starts shall not inherit them."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
