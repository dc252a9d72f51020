"""All sources of input merged into one, with one operator at a time."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from operator import add

from rastrainer.commands import deflection
from rastrainer_simulator.input.bindings import Bindings, Table
from rastrainer_simulator.input.gamepads import BUTTONS
from rastrainer_simulator.input.inputs import (
    ROTATION,
    TRANSLATION,
    VIEW,
    ControlContext,
    ControlName,
    InputDevice,
    Source,
    SourceKind,
)
from rastrainer_simulator.state import NEUTRAL_STICKS, OperatorInput

IDLE_S = 30.0
"""How long the holder has to be idle before another operator may take control.

A trainee who looks closely or listens to the instructor rests for some seconds, and is not asked.
"""
REPEAT_AFTER_S = 0.4
REPEAT_EVERY_S = 0.12

_REPEATED = (ControlName.UP, ControlName.DOWN, ControlName.LEFT, ControlName.RIGHT)


@dataclasses.dataclass(frozen=True)
class ControlsListener:
    """Callbacks for operations.

    `input_pressed` returns whether an input was consumed, as while a control is rebound. A source
    has `taken_over` the control from another operator, or is `refused`, as it has no control.
    """

    pressed: Callable[[ControlName], None]
    input_pressed: Callable[[InputDevice, str], bool]
    taken_over: Callable[[Source], None]
    refused: Callable[[Source], None]


class Controls:
    """The operator: the source of input that holds the control, and its deflections.

    The first source that acts holds the control. All sources at one station (the simulator's
    gamepad, the keys and the mouse of its windows; the keys, pad and controllers of one page)
    share it. Another station's input does nothing, except that pressing `menu` takes the control
    over once the holder has been idle for `IDLE_S` seconds, if it `may_be_taken`. A holder that is
    unplugged or leaves gives the control up. `bindings` may be exchanged at any time.
    """

    def __init__(
        self,
        bindings: Bindings,
        listener: ControlsListener,
        may_be_taken: Callable[[], bool] = lambda: True,
    ) -> None:
        self.bindings = bindings
        self.holder: Source | None = None
        self.situation = ControlContext.MENU
        self._listener = listener
        self._may_be_taken = may_be_taken
        self._states: dict[Source | None, InputState] = {}
        self._idle = 0.0
        self._repeating: tuple[Source, str, ControlName] | None = None
        self._repeat_in = 0.0

    @property
    def sticks(self) -> OperatorInput:
        if self.holder is None or self.situation is ControlContext.MENU:
            return NEUTRAL_STICKS
        return dataclasses.replace(self.held, operator=self.holder.kind.value)

    @property
    def held(self) -> OperatorInput:
        """The deflection of the holder's sticks, whether or not they move the arm."""
        state = self._states.get(self.holder)
        return NEUTRAL_STICKS if state is None else state.sticks(self.bindings)

    @property
    def view(self) -> tuple[float, float, float]:
        """The holder's commands to the view: around to the right, higher, nearer; −1…1 each."""
        state = self._states.get(self.holder)
        if state is None or self.situation is ControlContext.MENU:
            return 0.0, 0.0, 0.0
        around, higher, nearer = state.pushed(self.bindings.table(state.device), VIEW)
        return around, higher, nearer

    def is_operator(self, source: Source) -> bool:
        return self.holder is None or self.holder.station == source.station

    @property
    def has_gamepad(self) -> bool:
        """Whether a gamepad is plugged in here, or a browser's gamepad has moved."""
        return any(
            source.kind in (SourceKind.GAMEPAD, SourceKind.BROWSER_GAMEPAD)
            for source in self._states
            if source
        )

    def add(self, source: Source) -> InputState:
        """Return the state of a source, known before anything is pressed on it."""
        if source not in self._states:
            keys = source.kind is SourceKind.KEYBOARD
            self._states[source] = InputState(InputDevice.KEYBOARD if keys else InputDevice.GAMEPAD)
        return self._states[source]

    def enter(self, situation: ControlContext) -> None:
        """Change the situation; held inputs do nothing until they are released."""
        if situation is not self.situation:
            self.situation = situation
            self._repeating = None
            for state in self._states.values():
                state.block()

    def set_inputs(self, source: Source, values: Mapping[str, float]) -> None:
        """Process all inputs (0…1) of a gamepad."""
        state = self.add(source)
        pressed = state.set_inputs(values)
        self._noticed(source, state)
        self._press_all(source, state, pressed)

    def set_key(self, source: Source, code: str, is_down: bool) -> None:
        """Process a key of a keyboard; its repeats while it is held do not matter."""
        state = self.add(source)
        self._press_all(source, state, state.set_key(code, is_down))

    def set_sticks(self, source: Source, sticks: OperatorInput) -> None:
        state = self.add(source)
        state.set_sticks(sticks)
        self._noticed(source, state)

    def press(self, source: Source, control: ControlName) -> None:
        if self.allows(source, control):
            self._listener.pressed(control)

    def allows(self, source: Source, control: ControlName | None = None) -> bool:
        """Return whether a source may act, and give it control if so."""
        if self.is_operator(source):
            self.holder, self._idle = source, 0.0
            return True
        if control is ControlName.MENU and self._idle >= IDLE_S and self._may_be_taken():
            self.holder, self._idle = source, 0.0
            self._listener.taken_over(source)
            return False
        self._listener.refused(source)
        return False

    def forget(self, source: Source) -> None:
        """Drop a source that is gone: its inputs are released, and so is the control."""
        self._states.pop(source, None)
        if self._repeating is not None and self._repeating[0] == source:
            self._repeating = None
        if self.holder == source:
            self.holder = None

    def advance(self, dt: float) -> None:
        """Advance presses, repeated steps in menus, and idle time by `dt` seconds."""
        for state in self._states.values():
            state.advance(dt)
        held = self._states.get(self.holder)
        self._idle = self._idle + dt if held is None or held.is_at_rest else 0.0
        if self._repeating is None:
            return
        source, name, control = self._repeating
        if name not in self._states[source].down:
            self._repeating = None
            return
        self._repeat_in -= dt
        if self._repeat_in <= 0.0 and self._states[source].is_still_held(name):
            self._repeat_in = REPEAT_EVERY_S
            self._listener.pressed(control)

    def _noticed(self, source: Source, state: InputState) -> None:
        """Let pushed sticks pass on control within a station, or to a first operator."""
        if source == self.holder or state.is_at_rest:
            return
        holding = self._states.get(self.holder)
        if self.holder is None or (
            self.holder.station == source.station and (holding is None or holding.is_at_rest)
        ):
            self.holder, self._idle = source, 0.0

    def _press_all(self, source: Source, state: InputState, names: list[str]) -> None:
        for name in names:
            if self.is_operator(source) and self._listener.input_pressed(state.device, name):
                continue
            control = self.bindings.control(state.device, name, self.situation)
            if control is None or not self.allows(source, control):
                continue
            if control in _REPEATED:
                self._repeating = source, name, control
                self._repeat_in = REPEAT_AFTER_S
            self._listener.pressed(control)


DOWN_FROM = 0.6
UP_BELOW = 0.4
"""An input counts as pressed from the first on, and as released below the second."""
AT_REST_BELOW = 0.15
"""Released sticks come to rest up to about here, beyond the dead zone of `StickResponse`: a stick
that rests at its edge neither moves anything nor keeps the control."""
DRIFT_BELOW, FURTHER = 0.3, 0.2
"""An input that was held less far than the first when it was blocked, such as a worn stick that
does not return, is free again once it is pushed further by the second."""

STEP_PUSH, FINE_STEP_PUSH = 0.22, 0.4
"""How far a key or a button pushes its stick at first, and in slow motion: both mean 2 mm/s."""
STEP_S = 0.1
"""Every press lasts at least so long: a tap moves the tip by one step of 0.2 mm; in slow motion,
down onto the skin, of 0.1 mm."""
HOLD_AFTER_S, RAMP_S = 0.15, 0.6
"""Keys and buttons that are held speed up from the first until the second."""


class InputState:
    """The inputs of one source.

    Keys and buttons are pressed or not: a tap moves the tip by one small step, and a held key
    speeds up smoothly and stops at once. Inputs that are held while the situation changes do
    nothing until they are released: the arm must not start because a menu closes.
    """

    def __init__(self, device: InputDevice) -> None:
        self.device = device
        self._inputs: dict[str, float] = {}
        # For how long keys and buttons have been pressed, s; a tap stays here until its step ends.
        self._pressed_s: dict[str, float] = {}
        self.down: set[str] = set()
        self._again: set[str] = set()
        self._blocked: dict[str, float] = {}
        self._sticks = NEUTRAL_STICKS
        self._sticks_blocked = False

    @property
    def is_at_rest(self) -> bool:
        is_pushed = any(value >= AT_REST_BELOW for value in self._inputs.values())
        return not self.down and self._sticks == NEUTRAL_STICKS and not is_pushed

    def is_still_held(self, name: str) -> bool:
        """Return whether a pressed input is known to be held still.

        A key must have come down again since the last call: a window that draws slowly may not
        have reported its release yet.
        """
        if self.device is not InputDevice.KEYBOARD:
            return True
        has_come_again = name in self._again
        self._again.discard(name)
        return has_come_again

    def set_inputs(self, values: Mapping[str, float]) -> list[str]:
        """Take all inputs of a gamepad, 0…1; return those that have just been pressed."""
        self._inputs.update(values)
        pressed = []
        for name, value in self._inputs.items():
            held = self._blocked.get(name, 1.0)
            if value < AT_REST_BELOW or (held < DRIFT_BELOW and value > held + FURTHER):
                self._blocked.pop(name, None)
            if value >= DOWN_FROM and name not in self.down:
                self.down.add(name)
                pressed.append(name)
                if self.device is InputDevice.KEYBOARD or name in BUTTONS:
                    self._pressed_s[name] = 0.0
            elif value < UP_BELOW:
                self.down.discard(name)
        self.advance(0.0)
        return pressed

    def set_key(self, code: str, is_down: bool) -> list[str]:
        """Take a key; return it if it has just been pressed."""
        if is_down and code in self.down:
            self._again.add(code)
            return []
        self._again.discard(code)
        pressed = self.set_inputs({code: float(is_down)})
        if not is_down:
            del self._inputs[code]
        return pressed

    def set_sticks(self, sticks: OperatorInput) -> None:
        """Take sticks that need no bindings, as of a headset."""
        self._sticks = sticks
        self._sticks_blocked = self._sticks_blocked and _are_pushed(sticks)

    def block(self) -> None:
        """Ignore the inputs that are held now until they are released."""
        self._blocked = {
            name: value for name, value in self._inputs.items() if value >= AT_REST_BELOW
        }
        self._pressed_s.clear()
        self._sticks_blocked = _are_pushed(self._sticks)

    def advance(self, dt: float) -> None:
        """Advance presses by `dt` seconds, and end the steps of taps."""
        for name in tuple(self._pressed_s):
            self._pressed_s[name] += dt
            if self._pressed_s[name] >= STEP_S and name not in self.down:
                del self._pressed_s[name]

    def sticks(self, bindings: Bindings) -> OperatorInput:
        table = bindings.table(self.device)
        direct = NEUTRAL_STICKS if self._sticks_blocked else self._sticks
        is_fine = direct.fine or any(name in self.down for name in table[ControlName.FINE])
        step = FINE_STEP_PUSH if is_fine else STEP_PUSH
        right, forward, up = map(add, self.pushed(table, TRANSLATION, step), direct.translation)
        around, over = map(add, self.pushed(table, ROTATION, step), direct.rotation)
        return OperatorInput(
            translation=(deflection(right), deflection(forward), deflection(up)),
            rotation=(deflection(around), deflection(over)),
            fine=is_fine,
        )

    def pushed(
        self, table: Table, axes: Sequence[tuple[ControlName, ControlName]], step: float = 1.0
    ) -> tuple[float, ...]:
        """Return how far axes are pushed, −1…1; nothing if all are about at rest.

        Keys and buttons push by `step` at first.
        """
        pushed = [
            self._value(table[above], step) - self._value(table[below], step)
            for below, above in axes
        ]
        is_pushed = any(abs(value) >= AT_REST_BELOW for value in pushed)
        if self.device is InputDevice.GAMEPAD and not is_pushed:
            return (0.0,) * len(pushed)
        return tuple(pushed)

    def _value(self, names: tuple[str, ...], step: float) -> float:
        """Return how far the farthest of some inputs is pushed that are not blocked."""
        farthest = 0.0
        for name in names:
            if name in self._blocked:
                continue
            if self.device is InputDevice.GAMEPAD and name not in BUTTONS:
                pushed = self._inputs.get(name, 0.0)
            elif name in self._pressed_s:
                share = (self._pressed_s[name] - HOLD_AFTER_S) / (RAMP_S - HOLD_AFTER_S)
                # In steps that are not felt: every change is recorded.
                pushed = round(step + (1.0 - step) * min(1.0, max(0.0, share)), 2)
            else:
                continue
            farthest = max(farthest, pushed)
        return farthest


def _are_pushed(sticks: OperatorInput) -> bool:
    return any(abs(value) >= AT_REST_BELOW for value in (*sticks.translation, *sticks.rotation))
