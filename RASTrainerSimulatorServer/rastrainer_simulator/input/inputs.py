"""What can be pressed or pushed, and by whom: SDL's names for gamepads, the W3C's for keys.

A button is named as in SDL's GameController mappings ("a", "dpup"); an axis is two inputs, one for
each way it can be pushed ("-leftx", "+leftx"). A key is named by its `KeyboardEvent.code`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

BUTTONS = (
    "a",
    "b",
    "x",
    "y",
    "back",
    "guide",
    "start",
    "leftstick",
    "rightstick",
    "leftshoulder",
    "rightshoulder",
    "dpup",
    "dpdown",
    "dpleft",
    "dpright",
)
"""In SDL's order of GameController buttons."""

AXES = ("leftx", "lefty", "rightx", "righty", "lefttrigger", "righttrigger")
"""In SDL's order of GameController axes; y points down, triggers go from 0 to 1."""

GAMEPAD_INPUTS = frozenset((*BUTTONS, *(sign + axis for axis in AXES for sign in "-+")))

_KEY = re.compile(r"[A-Z][A-Za-z0-9]{0,31}")

_W3C_BUTTONS = (
    "a",
    "b",
    "x",
    "y",
    "leftshoulder",
    "rightshoulder",
    "+lefttrigger",
    "+righttrigger",
    "back",
    "start",
    "leftstick",
    "rightstick",
    "dpup",
    "dpdown",
    "dpleft",
    "dpright",
    "guide",
)
SIMULATOR_SEAT = "simulator"
"""The place at the simulator itself: its gamepad, and the keys and mouse of its windows."""


class InputDevice(str, Enum):
    """What the inputs belong to; each has its own bindings."""

    GAMEPAD = "gamepad"
    KEYBOARD = "keyboard"


def is_input(device: InputDevice, name: str) -> bool:
    """Tell whether a device has an input of that name."""
    if device is InputDevice.KEYBOARD:
        return _KEY.fullmatch(name) is not None
    return name in GAMEPAD_INPUTS


def gamepad_inputs(axes: Sequence[float], buttons: Sequence[float]) -> dict[str, float]:
    """Return the inputs (0…1) of a gamepad whose axes and buttons are in SDL's order."""
    return {**dict(zip(BUTTONS, buttons, strict=False)), **_halves(AXES, axes)}


def w3c_gamepad_inputs(axes: Sequence[float], buttons: Sequence[float]) -> dict[str, float]:
    """Return the same of a gamepad in the W3C's standard layout, as a browser reads it."""
    return {**dict(zip(_W3C_BUTTONS, buttons, strict=False)), **_halves(AXES[:4], axes)}


def _halves(names: Sequence[str], positions: Sequence[float]) -> dict[str, float]:
    halves = {}
    for name, position in zip(names, positions, strict=False):
        halves["-" + name] = max(0.0, -position)
        halves["+" + name] = max(0.0, position)
    return halves


class SourceKind(str, Enum):
    """What people read about who holds the control."""

    GAMEPAD = "gamepad"
    KEYBOARD = "keyboard"
    MOUSE = "mouse"
    TOUCH_SCREEN = "touch screen"
    BROWSER_GAMEPAD = "browser's gamepad"
    XR = "headset's controllers"


@dataclass(frozen=True)
class Source:
    """One thing that can hold the control.

    Attributes:
        kind: what it is.
        seat: where the person sits. What is at one seat belongs to one operator.
        view: number of the view that reads it; None for a gamepad at the simulator.
        number: of the gamepad, to tell several of one seat apart.
    """

    kind: SourceKind
    seat: str = SIMULATOR_SEAT
    view: int | None = None
    number: int = 0
