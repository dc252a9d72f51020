"""Gamepads: the names of their inputs, and the simulator's own gamepads, read by SDL.

A button is named as in SDL's GameController mappings ("a", "dpup"); an axis is two inputs, one for
each direction in which it can be pushed ("-leftx", "+leftx").
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType, ModuleType
from typing import Any, Literal, NamedTuple

from rastrainer.errors import RASTrainerError
from rastrainer.python_environment import temporary_environment

BUTTONS = (
    *("a", "b", "x", "y", "back", "guide", "start", "leftstick", "rightstick"),
    *("leftshoulder", "rightshoulder", "dpup", "dpdown", "dpleft", "dpright"),
)
"""In SDL's order of GameController buttons."""

AXES = ("leftx", "lefty", "rightx", "righty", "lefttrigger", "righttrigger")
"""In SDL's order of GameController axes; y points down, triggers go from 0 to 1."""

GAMEPAD_INPUTS = frozenset((*BUTTONS, *(sign + axis for axis in AXES for sign in "-+")))

_W3C_BUTTONS = (
    *("a", "b", "x", "y", "leftshoulder", "rightshoulder", "+lefttrigger", "+righttrigger"),
    *("back", "start", "leftstick", "rightstick", "dpup", "dpdown", "dpleft", "dpright", "guide"),
)


def w3c_gamepad_inputs(axes: Sequence[float], buttons: Sequence[float]) -> dict[str, float]:
    """Return all inputs of a gamepad in the W3C's standard layout, as a browser reads it."""
    return {**dict(zip(_W3C_BUTTONS, buttons, strict=False)), **_halves(AXES[:4], axes)}


def _halves(names: Sequence[str], positions: Sequence[float]) -> dict[str, float]:
    halves = {}
    for name, position in zip(names, positions, strict=False):
        halves["-" + name] = max(0.0, -position)
        halves["+" + name] = max(0.0, position)
    return halves


FULL_DEFLECTION = 32767.0
LONGEST_RUMBLE_S = 2.0
_HINTS = {
    "PYGAME_HIDE_SUPPORT_PROMPT": "1",
    "SDL_VIDEODRIVER": "dummy",
    "SDL_NO_SIGNAL_HANDLERS": "1",
    "SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS": "1",
}
"""Events come though no window of ours has the focus, and Ctrl-C stays the server's."""


class GamepadNews(NamedTuple):
    """An event of a gamepad, with all `inputs` (0…1) if it has moved.

    SDL knows no layout of an unknown gamepad, which has no number.
    """

    kind: Literal["added", "removed", "moved", "unknown"]
    number: int
    name: str
    inputs: Mapping[str, float] = MappingProxyType({})


class Gamepads:
    """Polls SDL; one poll takes some ten microseconds, and SDL's part of it leaves Python alone."""

    def __init__(self) -> None:
        """Start SDL; the first poll finds the gamepads."""
        self._pygame, self._controller = start_sdl()
        self._open: dict[int, Any] = {}
        self._reported: dict[int, tuple[tuple[float, ...], tuple[float, ...]]] = {}
        self._unknown: set[str] = set()
        self._has_looked = False

    def poll(self) -> Iterator[GamepadNews]:
        # `get` pumps SDL's events; `_look` finds which gamepads came or went.
        if self._pygame.event.get() or not self._has_looked:
            self._has_looked = True
            yield from self._look()
        for number, pad in self._open.items():
            axes = tuple(pad.get_axis(axis) / FULL_DEFLECTION for axis in range(len(AXES)))
            buttons = tuple(float(pad.get_button(button)) for button in range(len(BUTTONS)))
            if self._reported.get(number) != (axes, buttons):
                self._reported[number] = axes, buttons
                inputs = {**dict(zip(BUTTONS, buttons, strict=True)), **_halves(AXES, axes)}
                yield GamepadNews("moved", number, pad.name, inputs)

    def rumble(self, strength: float, seconds: float) -> None:
        milliseconds = int(1000.0 * min(seconds, LONGEST_RUMBLE_S))
        for pad in self._open.values():
            pad.rumble(strength, strength, milliseconds)

    def close(self) -> None:
        self._open.clear()
        self._controller.quit()
        self._pygame.display.quit()

    def _look(self) -> Iterator[GamepadNews]:
        for number, pad in tuple(self._open.items()):
            if not pad.attached():
                del self._open[number]
                self._reported.pop(number, None)
                yield GamepadNews("removed", number, pad.name)
        for index in range(self._pygame.joystick.get_count()):
            if not self._controller.is_controller(index):
                name = self._pygame.joystick.Joystick(index).get_name()
                if name not in self._unknown:
                    self._unknown.add(name)
                    yield GamepadNews("unknown", -1, name)
                continue
            pad = self._controller.Controller(index)
            number = pad.as_joystick().get_instance_id()
            if number not in self._open:
                self._open[number] = pad
                yield GamepadNews("added", number, pad.name)


class NoGamepadsError(RASTrainerError):
    """This computer cannot read gamepads."""


def start_sdl() -> tuple[ModuleType, ModuleType]:
    """Return pygame and its module of game controllers, both ready."""
    with temporary_environment(_HINTS):
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
