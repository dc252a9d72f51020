"""Bindings and presets: one meaning per input, a way out of every menu, what one hand reaches."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rastrainer.errors import InputError
from rastrainer_simulator.input.bindings import (
    BINDINGS_FILE,
    DEFAULT_BINDINGS,
    LAYOUTS,
    LEFT_ALONE,
    RIGHT_ALONE,
    Bindings,
    preset_name,
    read_bindings,
    write_bindings,
)
from rastrainer_simulator.input.gamepads import (
    GAMEPAD_INPUTS,
    w3c_gamepad_inputs,
)
from rastrainer_simulator.input.inputs import (
    OF_VIEW,
    ROTATION,
    ControlName,
    InputDevice,
)

CONTROLS = st.sampled_from(ControlName)


@given(st.lists(st.tuples(CONTROLS, st.sampled_from(sorted(GAMEPAD_INPUTS))), max_size=30))
def test_no_rebinding_leaves_a_control_without_input_or_an_input_with_two_meanings(changes):
    bindings = DEFAULT_BINDINGS
    for control, name in changes:
        try:
            bindings = bindings.rebound(InputDevice.GAMEPAD, control, name)
        except InputError:
            continue
        assert bindings.gamepad[control] == (name,)
    Bindings(bindings.gamepad, bindings.keyboard)


def test_a_file_in_which_an_input_has_two_meanings_is_refused_with_a_message(tmp_path):
    path = tmp_path / "controls.json"
    path.write_text('{"gamepad": {"touch": ["b"]}}')
    with pytest.raises(InputError, match="cannot do both touch and undo"):
        read_bindings(path)


def test_bindings_missing_from_a_file_keep_their_defaults(tmp_path):
    path = tmp_path / "controls.json"
    path.write_text(json.dumps({"formatVersion": 1, "keyboard": {"touch": ["KeyO"]}}))
    bindings = read_bindings(path)
    assert bindings.keyboard[ControlName.TOUCH] == ("KeyO",)
    assert bindings.keyboard[ControlName.UNDO] == DEFAULT_BINDINGS.keyboard[ControlName.UNDO]
    assert bindings.gamepad == DEFAULT_BINDINGS.gamepad


def test_a_browsers_gamepad_has_the_same_inputs_as_sdls():
    # The W3C's standard gamepad: buttons 0-3 are A, B, X, Y, 6 and 7 the triggers, 12 up.
    buttons = [0.0] * 17
    buttons[0], buttons[7], buttons[12] = 1.0, 0.5, 1.0
    inputs = w3c_gamepad_inputs([0.0, -1.0, 0.25, 0.0], buttons)
    moved = {name: value for name, value in inputs.items() if value > 0.0}
    assert moved == {"a": 1.0, "+righttrigger": 0.5, "dpup": 1.0, "-lefty": 1.0, "+rightx": 0.25}
    assert set(inputs) < GAMEPAD_INPUTS


BEST_OFF = OF_VIEW - {ControlName.BEST_VIEW}
TURNS = {name for pair in ROTATION for name in pair}
NEEDED = set(ControlName) - BEST_OFF - TURNS - {ControlName.CAMERA}
"""The controls that a trial by touches needs, from the start menu to the result."""
RIGHT_PAD = {"a", "b", "x", "y", "start", "rightstick", "rightshoulder", "+righttrigger"}
RIGHT_PAD |= {f"{sign}right{axis}" for sign in "-+" for axis in "xy"}
LEFT_PAD = {"dpup", "dpdown", "dpleft", "dpright", "back", "leftstick", "leftshoulder"}
LEFT_PAD |= {"+lefttrigger", *(f"{sign}left{axis}" for sign in "-+" for axis in "xy")}
LEFT_KEYS = {f"Key{letter}" for letter in "QWERTASDFGZXCVB"} | {"Tab", "ShiftLeft", "Space"}
LEFT_KEYS |= {"F1", "F2", "F3", "F4", "Escape", *(f"Digit{digit}" for digit in "12345")}
RIGHT_KEYS = {f"Key{letter}" for letter in "YUIOPHJKLBNM"} | {"ShiftRight", "Space", "Enter"}
RIGHT_KEYS |= {"Backspace", "Delete", *(f"Arrow{name}" for name in ("Up", "Down", "Left", "Right"))}
REACH = {
    (InputDevice.GAMEPAD, RIGHT_ALONE): RIGHT_PAD,
    (InputDevice.GAMEPAD, LEFT_ALONE): LEFT_PAD,
    (InputDevice.KEYBOARD, RIGHT_ALONE): RIGHT_KEYS,
    (InputDevice.KEYBOARD, LEFT_ALONE): LEFT_KEYS,
}
ALL = [(device, name) for device in InputDevice for name in LAYOUTS[device]]


def named(case):
    return case.value if isinstance(case, InputDevice) else case


@pytest.mark.parametrize(("device", "name"), ALL, ids=named)
def test_a_preset_gives_every_input_one_function_and_is_kept(device, name, tmp_path):
    table = LAYOUTS[device][name]
    bindings = replace(DEFAULT_BINDINGS, **{device.value: table})
    write_bindings(tmp_path / BINDINGS_FILE, bindings)
    assert read_bindings(tmp_path / BINDINGS_FILE) == bindings
    assert preset_name(device, table) == name


@pytest.mark.parametrize(("device", "name"), REACH, ids=named)
def test_one_hand_alone_reaches_everything_a_trial_needs(device, name):
    table, reach = LAYOUTS[device][name], REACH[device, name]
    # Upward a menu wraps around: going down leads everywhere.
    ways_up = {ControlName.UP} if (device, name) == (InputDevice.KEYBOARD, LEFT_ALONE) else set()
    out_of_reach = {each for each in NEEDED - ways_up if not reach & set(table[each])}
    assert out_of_reach == set()
