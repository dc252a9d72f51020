"""The settings file of the controls: read with suspicion, written as a whole."""

from __future__ import annotations

import json
from pathlib import Path
from types import MappingProxyType
from typing import Any

from rastrainer.errors import InputError
from rastrainer.files import read_json, write_text
from rastrainer.private_files import keep_others_out, make_private_folder
from rastrainer_simulator.controls.bindings import DEFAULT_BINDINGS, Bindings, Table
from rastrainer_simulator.controls.control_name import ControlName
from rastrainer_simulator.controls.inputs import Device, is_input

FILE_NAME = "controls.json"
FORMAT_VERSION = 1
MOST_BYTES = 2**16
MOST_INPUTS = 4


def read_bindings(path: Path) -> Bindings:
    """Return the bindings of a settings file; what it leaves out is as by default.

    Raises:
        InputError: the file cannot be read, or holds something else; the sentence names the field.
    """
    values = read_json(path, MOST_BYTES)
    if not isinstance(values, dict) or values.get("formatVersion") != FORMAT_VERSION:
        raise InputError(f"{path} must be a JSON object with the formatVersion {FORMAT_VERSION}.")
    unknown = set(values) - {"formatVersion", *Device}
    if unknown:
        raise InputError(f"{path} has an unknown field: it takes gamepad and keyboard.")
    try:
        return Bindings(**{device.value: _read_table(values, device) for device in Device})
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def write_bindings(path: Path, bindings: Bindings) -> None:
    """Save the bindings.

    Raises:
        InputError: the file cannot be written.
    """
    values: dict[str, Any] = {"formatVersion": FORMAT_VERSION}
    for device in Device:
        table = bindings.table(device)
        values[device.value] = {control.value: list(table[control]) for control in ControlName}
    try:
        make_private_folder(path.parent)
    except OSError as error:
        raise InputError(f"The folder {path.parent} cannot be made: {error.strerror}.") from None
    write_text(path, json.dumps(values, indent=2) + "\n")
    keep_others_out(path)


def _read_table(values: dict[str, Any], device: Device) -> Table:
    table = dict(DEFAULT_BINDINGS.table(device))
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
    return MappingProxyType(table)


def _read_inputs(device: Device, control: str, inputs: Any) -> tuple[str, ...]:
    is_list = isinstance(inputs, list) and 1 <= len(inputs) <= MOST_INPUTS
    if not is_list or not all(isinstance(name, str) and is_input(device, name) for name in inputs):
        example = '"a", "dpup" or "-leftx"' if device is Device.GAMEPAD else '"Space" or "KeyA"'
        raise InputError(
            f"the field {device.value}.{control} must be a list of 1 to {MOST_INPUTS} inputs, "
            f"such as {example}."
        )
    return tuple(dict.fromkeys(inputs))
