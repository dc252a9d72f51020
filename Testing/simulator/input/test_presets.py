"""Every layout of the controls works, and one for one hand has what a trial needs in its reach."""

from __future__ import annotations

from dataclasses import replace

import pytest

from rastrainer_simulator.input.bindings import (
    BINDINGS_FILE,
    DEFAULT_BINDINGS,
    read_bindings,
    write_bindings,
)
from rastrainer_simulator.input.inputs import OF_VIEW, ROTATION, ControlName, InputDevice
from rastrainer_simulator.input.presets import (
    LEFT_ALONE,
    RIGHT_ALONE,
    TWO_HANDS,
    preset_name,
    presets_of,
)

BEST_OFF = OF_VIEW - {ControlName.BEST_VIEW}
TURNS = {name for pair in ROTATION for name in pair}
NEEDED = set(ControlName) - BEST_OFF - TURNS - {ControlName.CAMERA}
"""What a trial by touches cannot do without: from the start menu to the result."""
RIGHT_PAD = {"a", "b", "x", "y", "start", "rightstick", "rightshoulder", "+righttrigger"}
RIGHT_PAD |= {f"{sign}right{axis}" for sign in "-+" for axis in "xy"}
LEFT_PAD = {"dpup", "dpdown", "dpleft", "dpright", "back", "leftstick", "leftshoulder"}
LEFT_PAD |= {"+lefttrigger", *(f"{sign}left{axis}" for sign in "-+" for axis in "xy")}
LEFT_KEYS = {f"Key{letter}" for letter in "QWERTASDFGZXCVB"} | {"Tab", "ShiftLeft", "Space"}
LEFT_KEYS |= {"F1", "F2", "F3", "F4", "Escape", *(f"Digit{digit}" for digit in "12345")}
RIGHT_KEYS = {f"Key{letter}" for letter in "YUIOPHJKLBNM"} | {"ShiftRight", "Space", "Enter"}
RIGHT_KEYS |= {"Backspace", "Delete", *(f"Arrow{way}" for way in ("Up", "Down", "Left", "Right"))}
REACH = {
    (InputDevice.GAMEPAD, RIGHT_ALONE): RIGHT_PAD,
    (InputDevice.GAMEPAD, LEFT_ALONE): LEFT_PAD,
    (InputDevice.KEYBOARD, RIGHT_ALONE): RIGHT_KEYS,
    (InputDevice.KEYBOARD, LEFT_ALONE): LEFT_KEYS,
}
ALL = [(device, name) for device in InputDevice for name in presets_of(device)]


def named(case):
    return case.value if isinstance(case, InputDevice) else case


@pytest.mark.parametrize(("device", "name"), ALL, ids=named)
def test_a_preset_gives_every_input_one_meaning_and_is_kept(device, name, tmp_path):
    table = presets_of(device)[name]
    bindings = replace(DEFAULT_BINDINGS, **{device.value: table})
    write_bindings(tmp_path / BINDINGS_FILE, bindings)
    assert read_bindings(tmp_path / BINDINGS_FILE) == bindings
    assert preset_name(device, table) == name


@pytest.mark.parametrize(("device", "name"), REACH, ids=named)
def test_one_hand_alone_reaches_all_that_a_trial_needs(device, name):
    table, reach = presets_of(device)[name], REACH[device, name]
    # Upward a menu wraps around: the way down leads everywhere.
    ways_up = {ControlName.UP} if (device, name) == (InputDevice.KEYBOARD, LEFT_ALONE) else set()
    out_of_reach = {each for each in NEEDED - ways_up if not reach & set(table[each])}
    assert out_of_reach == set()


def test_the_usual_layout_is_a_preset_and_a_changed_one_is_none():
    device = InputDevice.GAMEPAD
    assert preset_name(device, DEFAULT_BINDINGS.gamepad) == TWO_HANDS
    changed = DEFAULT_BINDINGS.rebound(device, ControlName.TOUCH, "x")
    assert preset_name(device, changed.gamepad) is None
