"""The input devices of a trainee: a gamepad, or the keyboard of the window."""

from __future__ import annotations

from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.input.inputs import ControlName
from Testing.end_to_end.virtual_display import VirtualKeyboard
from Testing.end_to_end.virtual_gamepad import SimulatorWithGamepad

HELD_S = 0.02
STICKS = (("KeyA", "KeyD"), ("KeyS", "KeyW"), ("KeyF", "KeyR"))


class GamepadHands:
    """A gamepad, held as a Logitech F310 is."""

    def __init__(self, simulator: SimulatorWithGamepad):
        self._simulator = simulator

    def tap(self, control: str) -> None:
        self._simulator.tap(DEFAULT_BINDINGS.gamepad[ControlName(control)][0], HELD_S)

    def push(self, right: float, forward: float, up: float, fine: bool) -> None:
        self._simulator.move(
            leftx=right, lefty=-forward, righty=-up, righttrigger=1.0 if fine else 0.0
        )


class KeyHands:
    """The keys of the window, which are pressed or not: the largest deflections are held."""

    def __init__(self, keyboard: VirtualKeyboard):
        self.keyboard = keyboard
        self._held: set[str] = set()

    def tap(self, control: str) -> None:
        self.keyboard.tap(DEFAULT_BINDINGS.keyboard[ControlName(control)][0])

    def type(self, text: str) -> None:
        for letter in text:
            self.keyboard.tap(f"Key{letter}" if letter.isalpha() else f"Digit{letter}")

    def push(self, right: float, forward: float, up: float, fine: bool) -> None:
        self._hold((right, forward, up), STICKS, fine)

    def _hold(self, values: tuple, keys: tuple, fine: bool) -> None:
        """Hold the keys of the larger values, each of which has two: below and above 0."""
        wanted = {"ShiftLeft"} if fine else set()
        longest = max(map(abs, values))
        for value, (below, above) in zip(values, keys, strict=True):
            if abs(value) > 0.5 * longest > 0.0:
                wanted.add(above if value > 0.0 else below)
        for code in sorted(self._held - wanted):
            self.keyboard.hold(code, False)
        for code in sorted(wanted - self._held):
            self.keyboard.hold(code, True)
        self._held = wanted
