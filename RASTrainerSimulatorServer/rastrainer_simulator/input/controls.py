"""All sources of input merged into one, with one operator at a time."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Protocol

from rastrainer_simulator.input.bindings import Bindings
from rastrainer_simulator.input.control_name import ControlContext, ControlName
from rastrainer_simulator.input.input_state import InputState
from rastrainer_simulator.input.inputs import InputDevice, Source, SourceKind
from rastrainer_simulator.operator_input import HANDS_OFF, OperatorInput

IDLE_S = 30.0
"""How long the holder has to rest before another operator may take the control.

A trainee who looks closely or listens to the instructor rests for some seconds, and is not asked.
"""
REPEAT_AFTER_S = 0.4
REPEAT_EVERY_S = 0.12

_REPEATED = (ControlName.UP, ControlName.DOWN, ControlName.LEFT, ControlName.RIGHT)


class ControlsListener(Protocol):
    """Receives what the operator presses."""

    def pressed(self, control: ControlName) -> None:
        """A control was pressed by the operator."""

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        """An input was pressed; return whether that was all, as while a control is rebound."""

    def taken_over(self, source: Source) -> None:
        """Another operator has taken the control."""

    def refused(self, source: Source) -> None:
        """Someone who is not in control wants to operate."""


class Controls:
    """Who holds the control, and what they do with it.

    Whoever acts first holds the control. What is at the same seat (the simulator's gamepad, the
    keys and the mouse of its windows; the keys, pad and controllers of one page) shares it and
    passes it on by being used. Another seat's input does nothing, except that pressing `menu`
    takes the control over once the holder has done nothing for `IDLE_S` seconds: on purpose,
    never while someone operates, and only where it `may_be_taken`. A holder that is unplugged or
    leaves gives the control up.

    Attributes:
        bindings: which input does what; may be exchanged at any time.
        holder: what drives the arm; None while nobody has acted.
        situation: whether the arm can be driven or a menu is open.
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
        self._states: dict[Source, InputState] = {}
        self._idle = 0.0
        self._repeating: tuple[Source, str, ControlName] | None = None
        self._repeat_in = 0.0

    @property
    def sticks(self) -> OperatorInput:
        """What the arm shall do; nothing while a menu is open."""
        if self.holder is None or self.situation is ControlContext.MENU:
            return HANDS_OFF
        sticks = self.held
        return dataclasses.replace(sticks, operator=self.holder.kind.value)

    @property
    def held(self) -> OperatorInput:
        """How the holder's sticks stand, whether or not they move the arm."""
        state = self._held_state
        return HANDS_OFF if state is None else state.sticks(self.bindings)

    @property
    def view(self) -> tuple[float, float, float]:
        """What the holder asks of the view: around to the right, higher, nearer; −1…1 each."""
        state = self._held_state
        if state is None or self.situation is ControlContext.MENU:
            return 0.0, 0.0, 0.0
        return state.view(self.bindings)

    def is_operator(self, source: Source) -> bool:
        """Return whether a source is at the seat of who holds the control, or nobody does."""
        return self.holder is None or self.holder.seat == source.seat

    @property
    def _held_state(self) -> InputState | None:
        """The inputs of the holder; None where nobody holds the control or they are not known."""
        return None if self.holder is None else self._states.get(self.holder)

    @property
    def has_gamepad(self) -> bool:
        """Whether a gamepad is plugged in here, or one that a browser reads has moved."""
        return any(
            source.kind in (SourceKind.GAMEPAD, SourceKind.BROWSER_GAMEPAD)
            for source in self._states
        )

    def add(self, source: Source) -> None:
        """Take a source that is plugged in, before anything is pressed on it."""
        self._state(source)

    def enter(self, situation: ControlContext) -> None:
        """Change the situation; what is held does nothing until it is released."""
        if situation is not self.situation:
            self.situation = situation
            self._repeating = None
            for state in self._states.values():
                state.block()

    def set_inputs(self, source: Source, values: Mapping[str, float]) -> None:
        """Take all inputs (0…1) of a gamepad."""
        state = self._state(source)
        pressed = state.set_inputs(values)
        self._noticed(source, state)
        self._press_all(source, state, pressed)

    def set_key(self, source: Source, code: str, is_down: bool) -> None:
        """Take a key of a keyboard; that it comes again while it is held does not matter."""
        state = self._state(source)
        pressed = state.set_key(code, is_down)
        self._press_all(source, state, pressed)

    def set_sticks(self, source: Source, sticks: OperatorInput) -> None:
        """Take the sticks of a headset's controllers."""
        state = self._state(source)
        state.set_sticks(sticks)
        self._noticed(source, state)

    def press(self, source: Source, control: ControlName) -> None:
        """Take one press of a control that needs no bindings."""
        if self.allows(source, control):
            self._listener.pressed(control)

    def allows(self, source: Source, control: ControlName | None = None) -> bool:
        """Return whether a source may act, and let it hold the control if so."""
        if self.is_operator(source):
            self._hold(source)
            return True
        if control is ControlName.MENU and self._idle >= IDLE_S and self._may_be_taken():
            self._hold(source)
            self._listener.taken_over(source)
            return False
        self._listener.refused(source)
        return False

    def forget(self, source: Source) -> None:
        """Drop a source that is gone: what it held is released, and so is the control."""
        self._states.pop(source, None)
        if self._repeating is not None and self._repeating[0] == source:
            self._repeating = None
        if self.holder == source:
            self.holder = None

    def advance(self, dt: float) -> None:
        """Advance by `dt` seconds: ramps, repeated steps in menus, and how long nobody acted."""
        for state in self._states.values():
            state.advance(dt)
        held = self._held_state
        self._idle = self._idle + dt if held is None or held.is_at_rest else 0.0
        self._repeat(dt)

    def _state(self, source: Source) -> InputState:
        if source not in self._states:
            keys = source.kind is SourceKind.KEYBOARD
            self._states[source] = InputState(InputDevice.KEYBOARD if keys else InputDevice.GAMEPAD)
        return self._states[source]

    def _noticed(self, source: Source, state: InputState) -> None:
        """Let pushed sticks pass the control on within a seat, or to a first operator."""
        if source == self.holder or state.is_at_rest:
            return
        holding = self._held_state
        if self.holder is None or (
            self.holder.seat == source.seat and (holding is None or holding.is_at_rest)
        ):
            self._hold(source)

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

    def _repeat(self, dt: float) -> None:
        if self._repeating is None:
            return
        source, name, control = self._repeating
        if not self._states[source].is_down(name):
            self._repeating = None
            return
        self._repeat_in -= dt
        if self._repeat_in <= 0.0 and self._states[source].is_still_held(name):
            self._repeat_in = REPEAT_EVERY_S
            self._listener.pressed(control)

    def _hold(self, source: Source) -> None:
        self.holder = source
        self._idle = 0.0
