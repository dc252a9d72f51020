"""The effect of inputs, the single operator, and steps that repeat while a direction is held."""

from __future__ import annotations

from itertools import pairwise

import pytest

from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.input.controls import (
    IDLE_S,
    RAMP_S,
    STEP_PUSH,
    STEP_S,
    Controls,
    InputState,
)
from rastrainer_simulator.input.inputs import (
    ControlContext,
    ControlName,
    InputDevice,
    Source,
    SourceKind,
)
from rastrainer_simulator.state import NEUTRAL_STICKS

GAMEPAD = Source(SourceKind.GAMEPAD)
KEYS = Source(SourceKind.KEYBOARD, view=1)
PAGE = Source(SourceKind.KEYBOARD, "view 2", 2)


class Ear:
    def __init__(self):
        self.presses, self.refusals, self.takers = [], [], []

    def pressed(self, control):
        self.presses.append(control)

    def input_pressed(self, _device, _name):
        return False

    def taken_over(self, source):
        self.takers.append(source)

    def refused(self, source):
        self.refusals.append(source)


@pytest.fixture
def ear():
    return Ear()


@pytest.fixture
def controls(ear):
    controls = Controls(DEFAULT_BINDINGS, ear)
    controls.enter(ControlContext.WORK)
    return controls


def tap(controls, source, code):
    controls.set_key(source, code, True)
    controls.set_key(source, code, False)


def test_nobody_has_control_until_somebody_acts(controls):
    controls.set_inputs(GAMEPAD, {"+leftx": 0.0, "a": 0.0})
    assert controls.holder is None
    assert controls.sticks == NEUTRAL_STICKS
    controls.set_inputs(GAMEPAD, {"+leftx": 0.4})
    assert controls.holder == GAMEPAD
    assert controls.sticks.operator == "gamepad"
    controls.advance(10.0 * IDLE_S)
    tap(controls, PAGE, "KeyM")
    assert controls.holder == GAMEPAD, "a holder who pushes a stick is never idle"


def test_the_menu_control_takes_over_from_an_idle_holder_and_does_nothing_else(controls, ear):
    controls.set_inputs(GAMEPAD, {"a": 1.0})
    controls.set_inputs(GAMEPAD, {"a": 0.0})
    # 30 s, as docs/views.md promises.
    controls.advance(29.0)
    tap(controls, PAGE, "KeyM")
    assert controls.holder == GAMEPAD
    controls.advance(2.0)
    tap(controls, PAGE, "KeyM")
    assert controls.holder == PAGE
    assert ear.takers == [PAGE]
    assert ear.presses == [ControlName.TOUCH]


def test_a_holder_that_has_left_no_longer_has_control(controls):
    controls.set_inputs(GAMEPAD, {"+leftx": 0.4})
    controls.forget(GAMEPAD)
    assert controls.sticks == NEUTRAL_STICKS
    controls.set_key(PAGE, "KeyD", True)
    assert controls.holder == PAGE


def test_a_key_repeats_in_a_menu_only_while_its_keyboard_repeats_it(controls, ear):
    controls.enter(ControlContext.MENU)
    controls.set_key(KEYS, "ArrowDown", True)
    # A window that draws for so long has not polled the release.
    controls.advance(3.0)
    assert ear.presses == [ControlName.DOWN]
    for _ in range(100):
        controls.set_key(KEYS, "ArrowDown", True)
        controls.advance(0.01)
    assert 8 <= len(ear.presses) <= 11
    controls.set_key(KEYS, "ArrowDown", False)
    steps = len(ear.presses)
    controls.set_key(KEYS, "ArrowDown", True)
    controls.advance(3.0)
    assert len(ear.presses) == steps + 1


def test_a_held_direction_repeats_in_a_menu_and_nothing_else_does(controls, ear):
    controls.enter(ControlContext.MENU)
    controls.set_inputs(GAMEPAD, {"dpdown": 1.0})
    for _ in range(100):
        controls.advance(0.01)
    steps = len(ear.presses)
    assert 4 <= steps <= 7
    assert set(ear.presses) == {ControlName.DOWN}
    controls.set_inputs(GAMEPAD, {"dpdown": 0.0})
    controls.set_inputs(GAMEPAD, {"a": 1.0})
    controls.advance(5.0)
    assert ear.presses[steps:] == [ControlName.ACCEPT]


def right(hand):
    return hand.sticks(DEFAULT_BINDINGS).translation[0]


def hand_with(device):
    """Return a hand that presses what moves the tip to the right, a key or a button."""
    hand = InputState(device)
    table = DEFAULT_BINDINGS.rebound(InputDevice.GAMEPAD, ControlName.MOVE_RIGHT, "dpright")

    def press(is_down):
        if device is InputDevice.KEYBOARD:
            hand.set_key("KeyD", is_down)
        else:
            hand.set_inputs({"dpright": float(is_down)})

    return hand, press, lambda: hand.sticks(table).translation[0]


@pytest.mark.parametrize(
    ("device", "held_s"), [(InputDevice.KEYBOARD, 0.0), (InputDevice.GAMEPAD, 0.09)]
)
def test_a_tap_is_one_step_however_short_it_was(device, held_s):
    hand, press, pushed = hand_with(device)
    press(True)
    hand.advance(held_s)
    press(False)
    moved, seconds = [], held_s
    while seconds < 3.0 * STEP_S:
        moved.append(pushed())
        hand.advance(0.01)
        seconds += 0.01
    assert set(moved) == {STEP_PUSH, 0.0}
    assert moved == sorted(moved, reverse=True)
    assert held_s + 0.01 * moved.count(STEP_PUSH) == pytest.approx(STEP_S, abs=0.011)


def test_a_key_or_button_pushes_harder_over_time_and_stops_at_once():
    hand, press, pushed_now = hand_with(InputDevice.KEYBOARD)
    press(True)
    pushed = [pushed_now()]
    for _ in range(10):
        hand.advance(RAMP_S / 8)
        pushed.append(pushed_now())
    assert 0.0 < pushed[0] < 0.5
    assert pushed == sorted(pushed)
    assert max(b - a for a, b in pairwise(pushed)) < 0.3
    assert pushed[-1] == 1.0
    press(False)
    assert pushed_now() == 0.0


def test_a_trembling_trigger_is_pressed_once():
    hand = InputState(InputDevice.GAMEPAD)
    values = (0.0, 0.65, 0.55, 0.65, 0.45, 0.7, 0.3, 0.7)
    pressed = [bool(hand.set_inputs({"+righttrigger": value})) for value in values]
    assert pressed == [False, True, False, False, False, False, False, True]


def test_inputs_held_through_a_change_count_only_after_being_released():
    hand = InputState(InputDevice.GAMEPAD)
    hand.set_inputs({"+leftx": 0.8, "-lefty": 0.0})
    hand.block()
    assert right(hand) == 0.0
    hand.set_inputs({"+leftx": 0.5, "-lefty": 0.9})
    assert hand.sticks(DEFAULT_BINDINGS).translation == (0.0, 0.9, 0.0)
    hand.set_inputs({"+leftx": 0.0})
    hand.set_inputs({"+leftx": 0.7})
    assert right(hand) == 0.7


DRIFT = {"+leftx": 0.11, "-lefty": 0.12, "-rightx": 0.14}


def test_a_stick_that_rests_at_the_edge_of_the_dead_zone_moves_nothing_and_gives_up_the_control(
    controls, ear
):
    controls.set_inputs(GAMEPAD, {"+leftx": 0.9})
    controls.set_inputs(GAMEPAD, DRIFT)
    assert controls.sticks.translation == (0.0, 0.0, 0.0)
    assert controls.sticks.rotation == (0.0, 0.0)
    assert controls.view == (0.0, 0.0, 0.0)
    controls.advance(IDLE_S + 1.0)
    tap(controls, PAGE, "KeyM")
    assert (controls.holder, ear.takers) == (PAGE, [PAGE])


@pytest.mark.parametrize("drift", [0.11, 0.28])
def test_a_stick_that_does_not_return_is_not_blocked_for_the_whole_trial(controls, drift):
    controls.set_inputs(GAMEPAD, {"a": 1.0, "+leftx": drift})
    controls.enter(ControlContext.MENU)
    controls.set_inputs(GAMEPAD, {"a": 0.0})
    controls.enter(ControlContext.WORK)
    controls.set_inputs(GAMEPAD, {"+leftx": drift + 0.005})
    assert controls.sticks.translation[0] == 0.0
    controls.set_inputs(GAMEPAD, {"+leftx": 0.8})
    assert controls.sticks.translation[0] == 0.8


def test_a_seat_switches_devices_by_using_one_but_not_while_a_stick_is_pushed(controls):
    controls.set_inputs(GAMEPAD, {"+leftx": 0.4})
    controls.set_inputs(Source(SourceKind.BROWSER_GAMEPAD, view=1), {"+lefty": 0.5})
    assert controls.holder == GAMEPAD
    controls.set_inputs(GAMEPAD, {"+leftx": 0.0})
    tap(controls, KEYS, "KeyC")
    assert controls.holder == KEYS
