"""All gamepads of the simulator: what they say, when they come and go, and their vibration."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from rastrainer_simulator.controls.inputs import AXES, BUTTONS, gamepad_inputs
from rastrainer_simulator.gamepad.sdl import start_sdl

FULL_DEFLECTION = 32767.0
LONGEST_RUMBLE_S = 2.0


class GamepadListener(Protocol):
    """Who is told about gamepads."""

    def gamepad_came(self, number: int, name: str) -> None:
        """A gamepad was plugged in."""

    def gamepad_moved(self, number: int, inputs: Mapping[str, float]) -> None:
        """Something of a gamepad has changed; all its inputs, 0…1."""

    def gamepad_went(self, number: int, name: str) -> None:
        """A gamepad was unplugged."""

    def gamepad_unknown(self, name: str) -> None:
        """A gamepad was plugged in whose layout SDL does not know."""


class Gamepads:
    """Polls SDL; one poll takes some ten microseconds, and SDL's part of it leaves Python alone."""

    def __init__(self, listener: GamepadListener) -> None:
        """Start SDL and find what is plugged in at the first poll.

        Raises:
            NoGamepadsError: this computer cannot read gamepads.
        """
        self._pygame, self._controller = start_sdl()
        self._listener = listener
        self._open: dict[int, Any] = {}
        self._told: dict[int, tuple[tuple[float, ...], tuple[float, ...]]] = {}
        self._unknown: set[str] = set()
        self._has_looked = False

    def poll(self) -> None:
        """Tell what has changed since the last poll."""
        # `get` pumps SDL's events; what came or went is looked for by asking.
        if self._pygame.event.get() or not self._has_looked:
            self._has_looked = True
            self._look()
        for number, pad in self._open.items():
            axes = tuple(pad.get_axis(axis) / FULL_DEFLECTION for axis in range(len(AXES)))
            buttons = tuple(float(pad.get_button(button)) for button in range(len(BUTTONS)))
            if self._told.get(number) != (axes, buttons):
                self._told[number] = axes, buttons
                self._listener.gamepad_moved(number, gamepad_inputs(axes, buttons))

    def rumble(self, strength: float, seconds: float) -> None:
        """Let all gamepads vibrate, those that can."""
        milliseconds = int(1000.0 * min(seconds, LONGEST_RUMBLE_S))
        for pad in self._open.values():
            pad.rumble(strength, strength, milliseconds)

    def close(self) -> None:
        """Let go of all gamepads and of SDL."""
        self._open.clear()
        self._controller.quit()
        self._pygame.display.quit()

    def _look(self) -> None:
        """Open what has come and forget what has gone."""
        for number, pad in tuple(self._open.items()):
            if not pad.attached():
                del self._open[number]
                self._told.pop(number, None)
                self._listener.gamepad_went(number, pad.name)
        for index in range(self._pygame.joystick.get_count()):
            if not self._controller.is_controller(index):
                self._tell_unknown(index)
                continue
            pad = self._controller.Controller(index)
            number = pad.as_joystick().get_instance_id()
            if number not in self._open:
                self._open[number] = pad
                self._listener.gamepad_came(number, pad.name)

    def _tell_unknown(self, index: int) -> None:
        name = self._pygame.joystick.Joystick(index).get_name()
        if name not in self._unknown:
            self._unknown.add(name)
            self._listener.gamepad_unknown(name)
