"""Which input does what, and the settings file for it."""

from __future__ import annotations

import re
import string
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer.files.writing import write_private_json
from rastrainer_simulator.input.gamepads import BUTTONS, GAMEPAD_INPUTS
from rastrainer_simulator.input.inputs import (
    OF_VIEW,
    SITUATIONS,
    ControlContext,
    ControlName,
    InputDevice,
)

Table = Mapping[ControlName, tuple[str, ...]]
BINDINGS_FILE = "controls.json"
FORMAT_VERSION = 1
MAX_BYTES = 2**16
MAX_INPUTS = 4
_KEY = re.compile(r"[A-Z][A-Za-z0-9]{0,31}")
"""A key is named by its `KeyboardEvent.code`, as the W3C has it."""


@dataclass(frozen=True)
class Bindings:
    """For each device and control the inputs that work it.

    Within a situation an input does one thing, and every control has an input: so that no
    settings file and no rebinding can leave the trainee without a way out of a menu.
    """

    gamepad: Table
    keyboard: Table

    def __post_init__(self) -> None:
        for device in InputDevice:
            _check(device, self.table(device))

    def table(self, device: InputDevice) -> Table:
        return self.gamepad if device is InputDevice.GAMEPAD else self.keyboard

    def control(
        self, device: InputDevice, name: str, situation: ControlContext
    ) -> ControlName | None:
        """Return what an input does in a situation, None where it does nothing."""
        for control, inputs in self.table(device).items():
            if name in inputs and situation in SITUATIONS[control]:
                return control
        return None

    def others(
        self, device: InputDevice, control: ControlName, name: str
    ) -> tuple[ControlName, ...]:
        """Return the controls that would lose an input if `control` took it."""
        return tuple(
            other
            for other, inputs in self.table(device).items()
            if name in inputs and other is not control and SITUATIONS[other] & SITUATIONS[control]
        )

    def rebound(self, device: InputDevice, control: ControlName, name: str) -> Bindings:
        """Return the bindings with `name` as the only input of a control.

        A control that it is taken from gets the former input in exchange.
        """
        table = dict(self.table(device))
        former = table[control][0]
        for other in self.others(device, control, name):
            kept = tuple(used for used in table[other] if used != name)
            table[other] = kept or (former,)
        table[control] = (name,)
        return replace(self, **{device.value: MappingProxyType(table)})


def _check(device: InputDevice, table: Table) -> None:
    for control in ControlName:
        if not table.get(control):
            raise InputError(f"The {device.value} needs an input for {control.value}.")
    for situation in ControlContext:
        taken: dict[str, ControlName] = {}
        for control, inputs in table.items():
            if situation not in SITUATIONS[control]:
                continue
            for name in inputs:
                if taken.setdefault(name, control) is not control:
                    raise InputError(
                        f"The {device.value}'s {name} cannot do both {taken[name].value} and "
                        f"{control.value}: give one of them another input."
                    )


_GAMEPAD: Mapping[str, tuple[str, ...]] = {
    "touch": ("a",),
    "undo": ("b",),
    "camera": ("y",),
    "fine": ("+righttrigger", "+lefttrigger"),
    "pause": ("back",),
    "menu": ("start",),
    "move_left": ("-leftx",),
    "move_right": ("+leftx",),
    "move_back": ("+lefty",),
    "move_forward": ("-lefty",),
    "move_down": ("+righty",),
    "move_up": ("-righty",),
    "turn_left": ("-rightx",),
    "turn_right": ("+rightx",),
    "turn_down": ("dpdown",),
    "turn_up": ("dpup",),
    "best_view": ("x",),
    "view_left": ("dpleft",),
    "view_right": ("dpright",),
    "view_lower": ("leftshoulder",),
    "view_higher": ("rightshoulder",),
    "view_farther": ("leftstick",),
    "view_nearer": ("rightstick",),
    "accept": ("a",),
    "back": ("b",),
    "up": ("dpup", "-lefty"),
    "down": ("dpdown", "+lefty"),
    "left": ("dpleft", "-leftx"),
    "right": ("dpright", "+leftx"),
}

_KEYBOARD: Mapping[str, tuple[str, ...]] = {
    "touch": ("Space", "Enter"),
    "undo": ("Backspace", "KeyU"),
    "camera": ("KeyC",),
    "fine": ("ShiftLeft", "ShiftRight"),
    "pause": ("KeyP",),
    "menu": ("KeyM", "F1"),
    "move_left": ("KeyA", "ArrowLeft"),
    "move_right": ("KeyD", "ArrowRight"),
    "move_back": ("KeyS", "ArrowDown"),
    "move_forward": ("KeyW", "ArrowUp"),
    "move_down": ("KeyF", "PageDown"),
    "move_up": ("KeyR", "PageUp"),
    "turn_left": ("KeyJ",),
    "turn_right": ("KeyL",),
    "turn_down": ("KeyK",),
    "turn_up": ("KeyI",),
    "best_view": ("KeyB",),
    "view_left": ("KeyQ",),
    "view_right": ("KeyE",),
    "view_lower": ("KeyG",),
    "view_higher": ("KeyT",),
    "view_farther": ("KeyZ",),
    "view_nearer": ("KeyX",),
    "accept": ("Enter", "Space", "NumpadEnter"),
    "back": ("Escape",),
    "up": ("ArrowUp",),
    "down": ("ArrowDown", "Tab"),
    "left": ("ArrowLeft",),
    "right": ("ArrowRight",),
}


_SPARE = {
    InputDevice.GAMEPAD: BUTTONS,
    InputDevice.KEYBOARD: tuple(f"Key{letter}" for letter in string.ascii_uppercase),
}


def _table(names: Mapping[str, tuple[str, ...]]) -> Table:
    return MappingProxyType({ControlName(name): inputs for name, inputs in names.items()})


DEFAULT_BINDINGS = Bindings(_table(_GAMEPAD), _table(_KEYBOARD))
"""The layout of a Logitech F310, and the keys of an American keyboard by their places."""


def read_bindings(path: Path) -> Bindings:
    """Return the bindings of a settings file; missing ones have their defaults."""
    values = read_json(path, MAX_BYTES)
    if not isinstance(values, dict) or values.get("formatVersion") != FORMAT_VERSION:
        raise InputError(f"{path} must be a JSON object with the formatVersion {FORMAT_VERSION}.")
    unknown = set(values) - {"formatVersion", *InputDevice}
    if unknown:
        raise InputError(f"{path} has an unknown field: it takes gamepad and keyboard.")
    try:
        return Bindings(**{device.value: _read_table(values, device) for device in InputDevice})
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def write_bindings(path: Path, bindings: Bindings) -> None:
    """Save the bindings."""
    values: dict[str, Any] = {"formatVersion": FORMAT_VERSION}
    for device in InputDevice:
        table = bindings.table(device)
        values[device.value] = {control.value: list(table[control]) for control in ControlName}
    write_private_json(path, values)


def _read_table(values: dict[str, Any], device: InputDevice) -> Table:
    table: dict[ControlName, tuple[str, ...]] = {}
    fields = values.get(device.value, {})
    if not isinstance(fields, dict):
        raise InputError(f"the field {device.value} must be an object.")
    for name, inputs in fields.items():
        try:
            control = ControlName(name)
        except ValueError:
            known = ", ".join(each.value for each in ControlName)
            raise InputError(f"{device.value} has an unknown control; known are {known}.") from None
        table[control] = _read_inputs(device, name, inputs)
    for control, usual in DEFAULT_BINDINGS.table(device).items():
        if control not in table:
            # Earlier versions' files do not know these, and may use their inputs for others.
            is_new = control in OF_VIEW
            table[control] = _free_inputs(device, table, control, usual) if is_new else usual
    return MappingProxyType({control: table[control] for control in ControlName})


def _free_inputs(
    device: InputDevice, table: Table, control: ControlName, usual: tuple[str, ...]
) -> tuple[str, ...]:
    """Return inputs for a control that a file leaves out, of those that the file leaves free."""
    taken = {
        name
        for other, inputs in table.items()
        if SITUATIONS[other] & SITUATIONS[control]
        for name in inputs
    }
    free = tuple(name for name in usual if name not in taken)
    others = {name for inputs in DEFAULT_BINDINGS.table(device).values() for name in inputs}
    spare = (name for name in _SPARE[device] if name not in taken)
    return free or tuple(sorted(spare, key=lambda name: name in others))[:1] or usual


def _is_input(device: InputDevice, name: str) -> bool:
    if device is InputDevice.KEYBOARD:
        return _KEY.fullmatch(name) is not None
    return name in GAMEPAD_INPUTS


def _read_inputs(device: InputDevice, control: str, inputs: Any) -> tuple[str, ...]:
    is_list = isinstance(inputs, list) and 1 <= len(inputs) <= MAX_INPUTS
    if not is_list or not all(isinstance(name, str) and _is_input(device, name) for name in inputs):
        example = (
            '"a", "dpup" or "-leftx"' if device is InputDevice.GAMEPAD else '"Space" or "KeyA"'
        )
        raise InputError(
            f"the field {device.value}.{control} must be a list of 1 to {MAX_INPUTS} inputs, "
            f"such as {example}."
        )
    return tuple(dict.fromkeys(inputs))
