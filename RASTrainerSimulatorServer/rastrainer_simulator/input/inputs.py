"""The sources of input, the controls, and the situation in which each counts."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

SIMULATOR_STATION = "simulator"
"""The place at the simulator itself: its gamepad, and the keys and mouse of its windows."""


class InputDevice(str, Enum):
    """The kinds of devices with bindings."""

    GAMEPAD = "gamepad"
    KEYBOARD = "keyboard"


class SourceKind(str, Enum):
    """The kinds of sources, as people read them."""

    GAMEPAD = "gamepad"
    KEYBOARD = "keyboard"
    MOUSE = "mouse"
    TOUCH_SCREEN = "touch screen"
    BROWSER_GAMEPAD = "browser's gamepad"
    XR = "headset's controllers"


@dataclass(frozen=True)
class Source:
    """One thing that can hold the control.

    All sources at one `station` belong to one operator. `view` is the number of the view that
    reads it, None for a gamepad at the simulator, whose `number` tells several apart.
    """

    kind: SourceKind
    station: str = SIMULATOR_STATION
    view: int | None = None
    number: int = 0


class ControlName(str, Enum):
    """The trainee's controls; each direction of a stick is a control."""

    # So that it is written as a name of a JSON object.
    __str__ = str.__str__

    TOUCH = "touch"
    UNDO = "undo"
    CAMERA = "camera"
    FINE = "fine"
    PAUSE = "pause"
    MENU = "menu"
    MOVE_LEFT = "move_left"
    MOVE_RIGHT = "move_right"
    MOVE_BACK = "move_back"
    MOVE_FORWARD = "move_forward"
    MOVE_DOWN = "move_down"
    MOVE_UP = "move_up"
    TURN_LEFT = "turn_left"
    TURN_RIGHT = "turn_right"
    TURN_DOWN = "turn_down"
    TURN_UP = "turn_up"
    BEST_VIEW = "best_view"
    VIEW_LEFT = "view_left"
    VIEW_RIGHT = "view_right"
    VIEW_LOWER = "view_lower"
    VIEW_HIGHER = "view_higher"
    VIEW_FARTHER = "view_farther"
    VIEW_NEARER = "view_nearer"
    ACCEPT = "accept"
    BACK = "back"
    UP = "up"
    DOWN = "down"
    LEFT = "left"
    RIGHT = "right"


class ControlContext(str, Enum):
    """Whether the trainee drives the arm or is in a menu: an input may do one thing in each."""

    WORK = "work"
    MENU = "menu"


TRANSLATION = (
    (ControlName.MOVE_LEFT, ControlName.MOVE_RIGHT),
    (ControlName.MOVE_BACK, ControlName.MOVE_FORWARD),
    (ControlName.MOVE_DOWN, ControlName.MOVE_UP),
)
"""Right, forward and up, each with the control that pushes it below and above zero."""

ROTATION = (
    (ControlName.TURN_LEFT, ControlName.TURN_RIGHT),
    (ControlName.TURN_DOWN, ControlName.TURN_UP),
)

VIEW = (
    (ControlName.VIEW_LEFT, ControlName.VIEW_RIGHT),
    (ControlName.VIEW_LOWER, ControlName.VIEW_HIGHER),
    (ControlName.VIEW_FARTHER, ControlName.VIEW_NEARER),
)
"""Around to the right, higher and nearer: what moves the view while it is held."""

OF_VIEW = frozenset({ControlName.BEST_VIEW, *(name for pair in VIEW for name in pair)})

STICKS = frozenset(name for pair in (*TRANSLATION, *ROTATION) for name in pair)

IN_MENUS = (
    ControlName.ACCEPT,
    ControlName.BACK,
    ControlName.UP,
    ControlName.DOWN,
    ControlName.LEFT,
    ControlName.RIGHT,
)

SITUATIONS = {
    name: {ControlContext.WORK, ControlContext.MENU}
    if name in (ControlName.PAUSE, ControlName.MENU)
    else {ControlContext.MENU if name in IN_MENUS else ControlContext.WORK}
    for name in ControlName
}
"""Where each control counts; two that count in the same situation cannot share an input."""

_IN_MENUS = {ControlName.TOUCH: ControlName.ACCEPT, ControlName.UNDO: ControlName.BACK}


def button_in_menu(name: str) -> ControlName | None:
    """Return what a view's own button does in a menu, by the name of its control; None if nothing.

    A headset's buttons have no bindings.
    """
    if name not in ControlName._value2member_map_:
        return None
    control = ControlName(name)
    return _IN_MENUS.get(control, control)
