"""Which input does what, ready-made layouts of that, and the settings file for it."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer.files.writing import write_private_json
from rastrainer.json_checks import whole_number
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer_simulator.input.gamepads import GAMEPAD_INPUTS
from rastrainer_simulator.input.inputs import SITUATIONS, ControlContext, ControlName, InputDevice

Table = Mapping[ControlName, tuple[str, ...]]
BINDINGS_FILE = "controls.json"
FORMAT_VERSION = 1
MAX_BYTES = 2**16
MAX_INPUTS = 4
TWO_HANDS, LEFT_HANDED = "two hands", "left-handed"
RIGHT_ALONE, LEFT_ALONE = "right alone", "left alone"
_KEY = re.compile(r"[A-Z][A-Za-z0-9]{0,31}")
"""A key is named by its `KeyboardEvent.code`, as the W3C has it."""
_EXAMPLES = {
    InputDevice.GAMEPAD: '"a", "dpup" or "-leftx"',
    InputDevice.KEYBOARD: '"Space" or "KeyA"',
}


def _table(device: InputDevice, usual: Table) -> Callable[[Any], Table]:
    """Accept an object of controls, each with its inputs; missing controls keep the `usual`."""

    def is_input(name: object) -> bool:
        if device is InputDevice.GAMEPAD:
            return name in GAMEPAD_INPUTS
        return isinstance(name, str) and _KEY.fullmatch(name) is not None

    def check(value: Any) -> Table:
        if not isinstance(value, Mapping):
            raise ValueError("an object")
        if unknown := value.keys() - set(ControlName):
            known = ", ".join(each.value for each in ControlName)
            raise ValueError(f"an object without {min(unknown)[:40]!r}; its names are {known}")
        for name, inputs in value.items():
            is_list = isinstance(inputs, (list, tuple)) and 1 <= len(inputs) <= MAX_INPUTS
            if not is_list or not all(map(is_input, inputs)):
                raise ValueError(
                    f"an object, its {name} a list of 1 to {MAX_INPUTS} inputs, such as "
                    f"{_EXAMPLES[device]}"
                )
        found = {ControlName(name): tuple(dict.fromkeys(value[name])) for name in value}
        return MappingProxyType({**usual, **found})

    return check


def _layouts(device: InputDevice) -> Mapping[str, Table]:
    path = Path(__file__).with_name("layouts.json")
    given = json.loads(path.read_text(encoding="utf-8"))[device.value]
    usual = _table(device, {})(given[TWO_HANDS])
    return {name: _table(device, usual)(others) for name, others in given.items()}


LAYOUTS: Mapping[InputDevice, Mapping[str, Table]] = {each: _layouts(each) for each in InputDevice}
"""For each device the ready-made layouts: for two hands (the default), for the left-handed, and for
one hand alone.

The default is for a Logitech F310, and the keys of an American keyboard by their places. A layout
for one hand has everything that a trial by touches needs within that hand's reach: up and down are
buttons for the thumb that otherwise pushes the stick. Turning the tool, which only procedures need,
and turning the view by hand stay with the other side: *Best view* turns it by one press.
"""
_PAD, _KEYS = LAYOUTS[InputDevice.GAMEPAD][TWO_HANDS], LAYOUTS[InputDevice.KEYBOARD][TWO_HANDS]


@dataclass(frozen=True)
class Bindings:
    """For each device and control the inputs that work it.

    Within a situation an input does one thing, and every control has an input: no settings file
    and no rebinding can leave the trainee without a way out of a menu.
    """

    gamepad: Annotated[Table, _table(InputDevice.GAMEPAD, _PAD)] = field(
        default_factory=lambda: _PAD
    )
    keyboard: Annotated[Table, _table(InputDevice.KEYBOARD, _KEYS)] = field(
        default_factory=lambda: _KEYS
    )
    format_version: Annotated[int, whole_number(FORMAT_VERSION, FORMAT_VERSION)] = FORMAT_VERSION

    def __post_init__(self) -> None:
        for device in InputDevice:
            _check(device, self.table(device))

    def table(self, device: InputDevice) -> Table:
        return self.gamepad if device is InputDevice.GAMEPAD else self.keyboard

    def with_table(self, device: InputDevice, table: Table) -> Bindings:
        is_pad = device is InputDevice.GAMEPAD
        return replace(self, gamepad=table) if is_pad else replace(self, keyboard=table)

    def control(
        self, device: InputDevice, name: str, situation: ControlContext
    ) -> ControlName | None:
        """Return the control that an input works in a situation, None if it works none."""
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
        return self.with_table(device, MappingProxyType(table))


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


DEFAULT_BINDINGS = Bindings()


def read_bindings(path: Path) -> Bindings:
    """Return the bindings of a settings file; missing controls have their defaults."""
    return record_from_json(Bindings, read_json(path, MAX_BYTES), str(path), only_known=True)


def write_bindings(path: Path, bindings: Bindings) -> None:
    write_private_json(path, record_to_json(bindings))


def preset_name(device: InputDevice, table: Table) -> str | None:
    """Return which ready-made layout a table is; None if the user has made it."""
    return next((name for name, layout in LAYOUTS[device].items() if layout == table), None)
