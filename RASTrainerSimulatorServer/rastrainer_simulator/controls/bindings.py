"""Which input does what."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from rastrainer.errors import InputError
from rastrainer_simulator.controls.control_name import SITUATIONS, ControlName, Situation
from rastrainer_simulator.controls.inputs import Device

Table = Mapping[ControlName, tuple[str, ...]]


@dataclass(frozen=True)
class Bindings:
    """For each device and control the inputs that work it.

    Within a situation an input does one thing, and every control has an input: so that no
    settings file and no rebinding can leave the trainee without a way out of a menu.
    """

    gamepad: Table
    keyboard: Table

    def __post_init__(self) -> None:
        for device in Device:
            _check(device, self.table(device))

    def table(self, device: Device) -> Table:
        """Return the inputs of each control of a device."""
        return self.gamepad if device is Device.GAMEPAD else self.keyboard

    def control(self, device: Device, name: str, situation: Situation) -> ControlName | None:
        """Return what an input does in a situation, None where it does nothing."""
        for control, inputs in self.table(device).items():
            if name in inputs and situation in SITUATIONS[control]:
                return control
        return None

    def others(self, device: Device, control: ControlName, name: str) -> tuple[ControlName, ...]:
        """Return the controls that would lose an input if `control` took it."""
        return tuple(
            other
            for other, inputs in self.table(device).items()
            if name in inputs and other is not control and SITUATIONS[other] & SITUATIONS[control]
        )

    def rebound(self, device: Device, control: ControlName, name: str) -> Bindings:
        """Return the bindings with `name` as the only input of a control.

        A control that it is taken from gets the former input in exchange.

        Raises:
            InputError: the exchange would give an input two meanings.
        """
        table = dict(self.table(device))
        former = table[control][0]
        for other in self.others(device, control, name):
            kept = tuple(used for used in table[other] if used != name)
            table[other] = kept or (former,)
        table[control] = (name,)
        return replace(self, **{device.value: MappingProxyType(table)})


def _check(device: Device, table: Table) -> None:
    for control in ControlName:
        if not table.get(control):
            raise InputError(f"The {device.value} needs an input for {control.value}.")
    for situation in Situation:
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
    "move_left": ("KeyA",),
    "move_right": ("KeyD",),
    "move_back": ("KeyS",),
    "move_forward": ("KeyW",),
    "move_down": ("KeyF", "PageDown"),
    "move_up": ("KeyR", "PageUp"),
    "turn_left": ("ArrowLeft",),
    "turn_right": ("ArrowRight",),
    "turn_down": ("ArrowDown",),
    "turn_up": ("ArrowUp",),
    "accept": ("Enter", "Space", "NumpadEnter"),
    "back": ("Escape",),
    "up": ("ArrowUp",),
    "down": ("ArrowDown", "Tab"),
    "left": ("ArrowLeft",),
    "right": ("ArrowRight",),
}


def _table(names: Mapping[str, tuple[str, ...]]) -> Table:
    return MappingProxyType({ControlName(name): inputs for name, inputs in names.items()})


DEFAULT_BINDINGS = Bindings(_table(_GAMEPAD), _table(_KEYBOARD))
"""The layout of a Logitech F310, and the keys of an American keyboard by their places."""
