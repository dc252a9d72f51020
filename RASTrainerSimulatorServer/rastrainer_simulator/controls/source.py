"""Where input comes from."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

SIMULATOR_SEAT = "simulator"
"""The place at the simulator itself: its gamepad, and the keys and mouse of its windows."""


class SourceKind(str, Enum):
    """What people read when they are told who holds the control."""

    GAMEPAD = "gamepad"
    KEYBOARD = "keyboard"
    MOUSE = "mouse"
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
