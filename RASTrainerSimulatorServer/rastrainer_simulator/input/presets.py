"""Ready-made layouts of the controls: for two hands, for the left-handed, and for one hand alone.

With one hand, everything that a trial by touches needs is within that hand's reach. Up and down are
buttons for the thumb that otherwise pushes the stick, so the tip is moved in one direction after
the other. Turning the tool, which only procedures need, and turning the view by hand stay with the
other side: *Best view* turns it by one press.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS, Table
from rastrainer_simulator.input.inputs import ControlName, InputDevice

TWO_HANDS, LEFT_HANDED = "two hands", "left-handed"
RIGHT_ALONE, LEFT_ALONE = "right alone", "left alone"

_LEFT_HANDED_PAD: Mapping[str, tuple[str, ...]] = {
    "touch": ("dpdown",),
    "undo": ("dpright",),
    "camera": ("dpup",),
    "best_view": ("dpleft",),
    "pause": ("start",),
    "menu": ("back",),
    "move_left": ("-rightx",),
    "move_right": ("+rightx",),
    "move_back": ("+righty",),
    "move_forward": ("-righty",),
    "move_down": ("+lefty",),
    "move_up": ("-lefty",),
    "turn_left": ("-leftx",),
    "turn_right": ("+leftx",),
    "turn_down": ("a",),
    "turn_up": ("y",),
    "view_left": ("x",),
    "view_right": ("b",),
    "up": ("dpup", "-righty"),
    "down": ("dpdown", "+righty"),
    "left": ("dpleft", "-rightx"),
    "right": ("dpright", "+rightx"),
}

_RIGHT_ALONE_PAD: Mapping[str, tuple[str, ...]] = {
    "touch": ("rightshoulder",),
    "undo": ("b",),
    "camera": ("leftshoulder",),
    "fine": ("+righttrigger",),
    "pause": ("rightstick",),
    "menu": ("start",),
    "move_left": ("-rightx",),
    "move_right": ("+rightx",),
    "move_back": ("+righty",),
    "move_forward": ("-righty",),
    "move_down": ("a",),
    "move_up": ("y",),
    "turn_left": ("-leftx",),
    "turn_right": ("+leftx",),
    "turn_down": ("+lefty",),
    "turn_up": ("-lefty",),
    "best_view": ("x",),
    "view_lower": ("dpdown",),
    "view_higher": ("dpup",),
    "view_farther": ("leftstick",),
    "view_nearer": ("back",),
    "up": ("dpup", "-righty"),
    "down": ("dpdown", "+righty"),
    "left": ("dpleft", "-rightx"),
    "right": ("dpright", "+rightx"),
}

_LEFT_ALONE_PAD: Mapping[str, tuple[str, ...]] = {
    "touch": ("leftshoulder",),
    "undo": ("dpleft",),
    "camera": ("rightshoulder",),
    "fine": ("+lefttrigger",),
    "pause": ("leftstick",),
    "menu": ("back",),
    "move_down": ("dpdown",),
    "move_up": ("dpup",),
    "turn_down": ("+righty",),
    "turn_up": ("-righty",),
    "best_view": ("dpright",),
    "view_left": ("x",),
    "view_right": ("b",),
    "view_lower": ("a",),
    "view_higher": ("y",),
    "view_farther": ("start",),
    "accept": ("leftshoulder", "a"),
    "back": ("+lefttrigger", "b"),
}

_RIGHT_ALONE_KEYS: Mapping[str, tuple[str, ...]] = {
    "undo": ("Backspace",),
    "camera": ("KeyH",),
    "fine": ("ShiftRight",),
    "pause": ("KeyY",),
    "move_left": ("KeyJ",),
    "move_right": ("KeyL",),
    "move_back": ("KeyK",),
    "move_forward": ("KeyI",),
    "move_down": ("KeyU", "PageDown"),
    "move_up": ("KeyO", "PageUp"),
    "turn_left": ("ArrowLeft",),
    "turn_right": ("ArrowRight",),
    "turn_down": ("ArrowDown",),
    "turn_up": ("ArrowUp",),
    "best_view": ("KeyP",),
    "view_left": ("Digit7",),
    "view_right": ("Digit8",),
    "view_lower": ("Digit9",),
    "view_higher": ("Digit0",),
    "view_farther": ("KeyB",),
    "view_nearer": ("KeyN",),
    "back": ("Delete", "Escape"),
}

_LEFT_ALONE_KEYS: Mapping[str, tuple[str, ...]] = {
    "undo": ("KeyQ",),
    "fine": ("ShiftLeft",),
    "pause": ("F4",),
    "menu": ("F1",),
    "move_left": ("KeyA",),
    "move_right": ("KeyD",),
    "move_back": ("KeyS",),
    "move_forward": ("KeyW",),
    "move_down": ("KeyF",),
    "move_up": ("KeyR",),
    "turn_left": ("Digit1",),
    "turn_right": ("Digit2",),
    "turn_down": ("Digit3",),
    "turn_up": ("Digit4",),
    "best_view": ("KeyE",),
    "view_left": ("KeyZ",),
    "view_right": ("KeyX",),
    "view_lower": ("KeyG",),
    "view_higher": ("KeyT",),
    "view_farther": ("KeyV",),
    "view_nearer": ("KeyB",),
    "accept": ("Space", "Enter", "NumpadEnter"),
    "down": ("Tab", "ArrowDown"),
    "left": ("F2", "ArrowLeft"),
    "right": ("F3", "ArrowRight"),
}


def _table(device: InputDevice, others: Mapping[str, tuple[str, ...]]) -> Table:
    changed = {ControlName(name): inputs for name, inputs in others.items()}
    return MappingProxyType({**DEFAULT_BINDINGS.table(device), **changed})


_TABLES: Mapping[InputDevice, Mapping[str, Table]] = {
    InputDevice.GAMEPAD: {
        TWO_HANDS: DEFAULT_BINDINGS.gamepad,
        LEFT_HANDED: _table(InputDevice.GAMEPAD, _LEFT_HANDED_PAD),
        RIGHT_ALONE: _table(InputDevice.GAMEPAD, _RIGHT_ALONE_PAD),
        LEFT_ALONE: _table(InputDevice.GAMEPAD, _LEFT_ALONE_PAD),
    },
    InputDevice.KEYBOARD: {
        TWO_HANDS: DEFAULT_BINDINGS.keyboard,
        RIGHT_ALONE: _table(InputDevice.KEYBOARD, _RIGHT_ALONE_KEYS),
        LEFT_ALONE: _table(InputDevice.KEYBOARD, _LEFT_ALONE_KEYS),
    },
}


def presets_of(device: InputDevice) -> Mapping[str, Table]:
    """Return a device's layouts by their names; keys have none specifically for the left-handed."""
    return _TABLES[device]


def preset_name(device: InputDevice, table: Table) -> str | None:
    """Return which preset a table is; None if the user has made it."""
    return next((name for name, preset in _TABLES[device].items() if preset == table), None)
