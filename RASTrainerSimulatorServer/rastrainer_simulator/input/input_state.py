"""One source's inputs, read as controls."""

from __future__ import annotations

from collections.abc import Mapping

from rastrainer_simulator.input.bindings import Bindings, Table
from rastrainer_simulator.input.control_name import ROTATION, TRANSLATION, VIEW, ControlName
from rastrainer_simulator.input.inputs import InputDevice
from rastrainer_simulator.operator_input import OperatorInput

DOWN_FROM = 0.6
UP_BELOW = 0.4
"""An input counts as pressed from the first on, and as released below the second."""
AT_REST_BELOW = 0.1

RAMP_START = 0.25
RAMP_S = 0.25
"""A key is a stick that is pushed a little at once and fully after so long."""

_UNUSED = OperatorInput()


class InputState:
    """What a source is doing.

    Keys are ramped, so that a tap moves the tip a little; they stop at once, as a released stick
    does. What is held while the situation changes does nothing until it is released: the arm must
    not start because a menu closes.

    Attributes:
        device: whose bindings count.
    """

    def __init__(self, device: InputDevice) -> None:
        self.device = device
        self._inputs: dict[str, float] = {}
        self._down: set[str] = set()
        self._again: set[str] = set()
        self._blocked: set[str] = set()
        self._sticks = _UNUSED
        self._sticks_blocked = False

    @property
    def is_at_rest(self) -> bool:
        """Whether nothing is pressed or pushed."""
        return not self._down and self._sticks == _UNUSED and not any(map(_is_pushed, self._values))

    @property
    def _values(self) -> tuple[float, ...]:
        return tuple(self._inputs.values())

    def is_down(self, name: str) -> bool:
        """Whether an input is pressed."""
        return name in self._down

    def is_still_held(self, name: str) -> bool:
        """Return whether an input that is pressed is known to be held still.

        A key is if it has come down again since it was asked for last. That no release has come
        says nothing: a window that draws slowly may not have looked.
        """
        if self.device is not InputDevice.KEYBOARD:
            return True
        has_come_again = name in self._again
        self._again.discard(name)
        return has_come_again

    def set_inputs(self, values: Mapping[str, float]) -> list[str]:
        """Take all inputs of a gamepad, 0…1; return those that have just been pressed."""
        self._inputs.update(values)
        return self._pressed()

    def set_key(self, code: str, is_down: bool) -> list[str]:
        """Take a key; return it if it has just been pressed."""
        if is_down:
            self._inputs.setdefault(code, RAMP_START)
            if code in self._down:
                self._again.add(code)
                return []
            self._down.add(code)
            return [code]
        self._inputs.pop(code, None)
        for those in (self._down, self._again, self._blocked):
            those.discard(code)
        return []

    def set_sticks(self, sticks: OperatorInput) -> None:
        """Take sticks that need no bindings, those of a headset."""
        self._sticks = sticks
        self._sticks_blocked = self._sticks_blocked and _are_pushed(sticks)

    def block(self) -> None:
        """Ignore what is held now until it is released."""
        self._blocked = {name for name, value in self._inputs.items() if _is_pushed(value)}
        self._sticks_blocked = _are_pushed(self._sticks)

    def advance(self, dt: float) -> None:
        """Advance the ramps of the keys by `dt` seconds."""
        if self.device is InputDevice.KEYBOARD:
            for code, value in self._inputs.items():
                self._inputs[code] = min(1.0, value + (1.0 - RAMP_START) * dt / RAMP_S)

    def sticks(self, bindings: Bindings) -> OperatorInput:
        """Return what the sticks and keys ask of the arm."""
        table = bindings.table(self.device)

        def deflection(below: ControlName, above: ControlName, direct: float) -> float:
            return max(-1.0, min(1.0, self._deflection(table, below, above) + direct))

        is_fine = any(self.is_down(name) for name in table[ControlName.FINE])
        direct = _UNUSED if self._sticks_blocked else self._sticks
        return OperatorInput(
            translation=(
                deflection(*TRANSLATION[0], direct.translation[0]),
                deflection(*TRANSLATION[1], direct.translation[1]),
                deflection(*TRANSLATION[2], direct.translation[2]),
            ),
            rotation=(
                deflection(*ROTATION[0], direct.rotation[0]),
                deflection(*ROTATION[1], direct.rotation[1]),
            ),
            fine=is_fine or direct.fine,
        )

    def view(self, bindings: Bindings) -> tuple[float, float, float]:
        """Return what is held to move the view: around to the right, higher, nearer; −1…1 each."""
        table = bindings.table(self.device)
        around, higher, nearer = (self._deflection(table, below, above) for below, above in VIEW)
        return around, higher, nearer

    def _deflection(self, table: Table, below: ControlName, above: ControlName) -> float:
        return self._value(table[above]) - self._value(table[below])

    def _value(self, names: tuple[str, ...]) -> float:
        """Return how far the farthest of some inputs is pushed that are not blocked."""
        free = (name for name in names if name not in self._blocked)
        return max((self._inputs.get(name, 0.0) for name in free), default=0.0)

    def _pressed(self) -> list[str]:
        pressed = []
        for name, value in self._inputs.items():
            if not _is_pushed(value):
                self._blocked.discard(name)
            if value >= DOWN_FROM and name not in self._down:
                self._down.add(name)
                pressed.append(name)
            elif value < UP_BELOW:
                self._down.discard(name)
        return pressed


def _is_pushed(value: float) -> bool:
    return value >= AT_REST_BELOW


def _are_pushed(sticks: OperatorInput) -> bool:
    return any(abs(value) >= AT_REST_BELOW for value in (*sticks.translation, *sticks.rotation))
