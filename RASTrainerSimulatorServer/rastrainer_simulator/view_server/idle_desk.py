"""A desk at which nobody sits: views can watch, and nothing that they send has any effect."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rastrainer_simulator.flow.screen import Screen
from rastrainer_simulator.view_server.operator_desk import Control, Frames, Hello, News


class IdleDesk:
    """An `OperatorDesk` for watching only."""

    screen = Screen()
    control = Control()

    def subscribe(self, _listener: Callable[[News], None]) -> Callable[[], None]:
        """There is never anything to tell."""
        return lambda: None

    def view_joined(self, view: int, hello: Hello) -> None:
        """Nothing depends on it."""

    def view_left(self, view: int) -> None:
        """Nothing depends on it."""

    def on_key(self, view: int, code: str, is_down: bool, text: str) -> None:
        """Keys do nothing."""

    def on_pad(self, view: int, axes: Sequence[float], buttons: Sequence[float]) -> None:
        """Pads do nothing."""

    def on_sticks(
        self,
        view: int,
        translation: tuple[float, float, float],
        rotation: tuple[float, float],
        is_fine: bool,
    ) -> None:
        """Sticks do nothing."""

    def on_press(self, view: int, control: str) -> None:
        """Buttons do nothing."""

    def on_item(self, view: int, name: str) -> None:
        """There is no menu."""

    def on_text(self, view: int, name: str, value: str) -> None:
        """There is no menu."""

    def on_frames(self, view: int, frames: Frames) -> None:
        """Nobody keeps them."""

    def on_visibility(self, view: int, is_visible: bool) -> None:
        """Nothing depends on it."""
