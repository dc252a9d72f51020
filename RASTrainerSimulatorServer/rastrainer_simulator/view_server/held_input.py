"""What one view holds down, so that it is let go when the view does not say so any more."""

from __future__ import annotations

from collections.abc import Sequence

from rastrainer_simulator.view_server.operator_desk import OperatorDesk

MOST_KEYS = 32


class HeldInput:
    """Passes a view's keys, pads and sticks on to the desk and can release them all."""

    def __init__(self, view: int, desk: OperatorDesk) -> None:
        self._view = view
        self._desk = desk
        self._keys: dict[str, None] = {}
        self._pad: tuple[int, int] | None = None
        self._has_sticks = False

    @property
    def is_anything_held(self) -> bool:
        """Whether `release` would have something to do."""
        return bool(self._keys) or self._pad is not None or self._has_sticks

    def key(self, code: str, is_down: bool, text: str) -> None:
        """Take a key; no hand holds more than a few, so further ones are passed over."""
        if not is_down:
            self._keys.pop(code, None)
        elif code in self._keys or len(self._keys) < MOST_KEYS:
            self._keys[code] = None
        else:
            return
        self._desk.on_key(self._view, code, is_down, text)

    def pad(self, axes: Sequence[float], buttons: Sequence[float]) -> None:
        """Take a gamepad's position."""
        self._pad = (len(axes), len(buttons)) if any(axes) or any(buttons) else None
        self._desk.on_pad(self._view, axes, buttons)

    def sticks(
        self,
        translation: tuple[float, float, float],
        rotation: tuple[float, float],
        is_fine: bool,
    ) -> None:
        """Take the sticks of XR controllers."""
        self._has_sticks = any(translation) or any(rotation) or is_fine
        self._desk.on_sticks(self._view, translation, rotation, is_fine)

    def release(self) -> None:
        """Let go of everything."""
        for code in tuple(self._keys):
            self.key(code, False, "")
        if self._pad is not None:
            axes, buttons = self._pad
            self.pad((0.0,) * axes, (0.0,) * buttons)
        if self._has_sticks:
            self.sticks((0.0, 0.0, 0.0), (0.0, 0.0), False)
