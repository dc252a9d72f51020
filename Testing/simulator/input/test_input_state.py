"""What a hand does: keys ramp up and stop at once; what was held through a menu waits."""

from __future__ import annotations

import pytest

from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.input.controls import RAMP_S, InputState
from rastrainer_simulator.input.inputs import InputDevice
from rastrainer_simulator.state import OperatorInput


def right(hand):
    return hand.sticks(DEFAULT_BINDINGS).translation[0]


def test_a_key_pushes_more_and_more_and_stops_at_once():
    hand = InputState(InputDevice.KEYBOARD)
    hand.set_key("KeyD", True)
    pushed = [right(hand)]
    for _ in range(10):
        hand.advance(RAMP_S / 8)
        pushed.append(right(hand))
    assert 0.0 < pushed[0] < 0.5
    assert pushed == sorted(pushed)
    assert pushed[-1] == 1.0
    hand.set_key("KeyD", False)
    assert right(hand) == 0.0


def test_opposite_keys_cancel():
    hand = InputState(InputDevice.KEYBOARD)
    hand.set_key("KeyD", True)
    hand.set_key("KeyA", True)
    assert right(hand) == 0.0


def test_a_key_that_a_keyboard_repeats_is_pressed_once():
    hand = InputState(InputDevice.KEYBOARD)
    assert [hand.set_key("Space", True) for _ in range(3)] == [["Space"], [], []]
    hand.set_key("Space", False)
    assert hand.set_key("Space", True) == ["Space"]


def test_a_trembling_trigger_is_pressed_once():
    hand = InputState(InputDevice.GAMEPAD)
    values = (0.0, 0.65, 0.55, 0.65, 0.45, 0.7, 0.3, 0.7)
    pressed = [bool(hand.set_inputs({"+righttrigger": value})) for value in values]
    assert pressed == [False, True, False, False, False, False, False, True]


def test_what_is_held_through_a_change_counts_only_after_it_was_let_go():
    hand = InputState(InputDevice.GAMEPAD)
    hand.set_inputs({"+leftx": 0.8, "-lefty": 0.0})
    hand.block()
    assert right(hand) == 0.0
    hand.set_inputs({"+leftx": 0.5, "-lefty": 0.9})
    assert hand.sticks(DEFAULT_BINDINGS).translation == (0.0, 0.9, 0.0)
    hand.set_inputs({"+leftx": 0.0})
    hand.set_inputs({"+leftx": 0.7})
    assert right(hand) == 0.7


def test_a_headset_s_sticks_wait_likewise():
    hand = InputState(InputDevice.GAMEPAD)
    pushed = OperatorInput((0.5, 0.0, 0.0), (0.0, 0.2), True)
    hand.set_sticks(pushed)
    hand.block()
    assert right(hand) == 0.0
    hand.set_sticks(OperatorInput())
    hand.set_sticks(pushed)
    assert right(hand) == 0.5
    assert hand.sticks(DEFAULT_BINDINGS).fine


def test_sticks_that_rested_through_a_change_count_at_their_first_push():
    hand = InputState(InputDevice.GAMEPAD)
    hand.set_sticks(OperatorInput())
    hand.block()
    hand.set_sticks(OperatorInput((0.5, 0.0, 0.0)))
    assert right(hand) == 0.5


@pytest.mark.parametrize(("value", "is_at_rest"), [(0.05, True), (0.5, False), (0.9, False)])
def test_a_stick_near_its_middle_is_at_rest(value, is_at_rest):
    hand = InputState(InputDevice.GAMEPAD)
    hand.set_inputs({"+leftx": value})
    assert hand.is_at_rest is is_at_rest
