"""Two sticks that views draw on request, for who has nothing but a mouse."""

from __future__ import annotations

from rastrainer_simulator.input.inputs import ControlName
from rastrainer_simulator.state import OperatorInput

SHOW, TILT = "sticks", "tilt"
"""What is clicked to show or hide the sticks, and to have the right one tilt the tool."""


class ScreenSticks:
    """Whether the sticks are shown, and what one click has changed of what they do.

    A mouse pushes one stick at a time and cannot hold a button meanwhile: what other devices hold
    is switched on and off here.

    Attributes:
        is_shown: whether views draw them while the arm is driven.
        is_slow: whether they move the tool slowly.
        is_tilting: whether the right stick tilts the tool in place of lifting and lowering it.
    """

    def __init__(self) -> None:
        self.is_shown = False
        self.is_slow = False
        self.is_tilting = False

    def pressed(self, name: str) -> bool:
        """Switch what a click is for; return whether it is for the sticks."""
        if name == SHOW:
            self.is_shown = not self.is_shown
        elif name == TILT:
            self.is_tilting = not self.is_tilting
        elif name == ControlName.FINE.value:
            self.is_slow = not self.is_slow
        else:
            return False
        return True

    def moved(
        self, translation: tuple[float, float, float], rotation: tuple[float, float]
    ) -> OperatorInput:
        """Return what the sticks mean, as `OperatorInput` has it."""
        right, forward, up = translation
        if self.is_tilting:
            rotation, up = (rotation[0], up), 0.0
        is_pushed = any((right, forward, up, *rotation))
        return OperatorInput((right, forward, up), rotation, self.is_slow and is_pushed)
