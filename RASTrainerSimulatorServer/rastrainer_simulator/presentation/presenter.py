"""What stands between the views and the simulation: who reads what, and what each control does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer_simulator.loop.results import Subscribers
from rastrainer_simulator.presentation.messages import (
    Feedback,
    Frames,
    Hello,
    InstructorOrder,
    Seat,
    SkinPlace,
)
from rastrainer_simulator.presentation.screen import Screen
from rastrainer_simulator.state import SimulationState
from rastrainer_simulator.viewpoint.view_control import Pictures


@dataclass(frozen=True)
class Control:
    """What drives the arm.

    Attributes:
        holder: what people read, such as "gamepad" or "keyboard"; "" while no one drives.
        view: number of the view that the holder's input comes from; None for a gamepad at the
            simulator, and while no one drives.
    """

    holder: str = ""
    view: int | None = None


ViewUpdate = Screen | Feedback | Control


@dataclass(frozen=True)
class TraceGuidance:
    """How a trainee who traces the skin is guided.

    Attributes:
        covered_mm: so far around the traced points the skin is painted; 0 where it is not.
        next_place: where the next points would help most; None where that is not shown.
    """

    covered_mm: float = 0.0
    next_place: SkinPlace | None = None


class Presenter:
    """What the view server shows, and where it passes on what views send; ignores it by default.

    Everything is called in the event loop's thread, and what is subscribed is called there too;
    every call returns at once. Values have been checked: numbers are finite and within their
    range, texts short and printable, `view` is the number of a view that has joined. Each message
    of a view goes to the method of its type.

    Attributes:
        updates: each new screen, feedback and holder of the control.
    """

    screen: Screen
    control = Control()

    def __init__(self) -> None:
        self.updates: Subscribers[ViewUpdate] = Subscribers()

    def pictures(self, now: SimulationState) -> Pictures:
        raise NotImplementedError

    def ghost(self, now: SimulationState) -> tuple[np.ndarray, ...] | None:  # noqa: ARG002
        """Return the poses of the ghost beside the arm in a state, in the order of `GHOST_BODIES`.

        Each is (4, 4) float, to World, m; None where none is shown.
        """
        return None

    def trace_guidance(self, now: SimulationState) -> TraceGuidance:  # noqa: ARG002
        """Return how a trainee who traces the skin is guided in a state."""
        return TraceGuidance()

    def seat(self) -> Seat:
        """Return what a teacher's board shows of this seat; nothing where no one trains."""
        return Seat()

    def instruct(self, order: InstructorOrder, text: str) -> str:
        """Carry out an order of a teacher who knows the PIN; return why it is impossible, or "".

        `text` is the sentence of `InstructorOrder.SAY`, else "".
        """
        raise NotImplementedError

    def view_joined(self, view: int, hello: Hello) -> None:
        """Register a view."""

    def view_left(self, view: int) -> None:
        """Forget a view; what it held has been released before."""

    def on_key(self, view: int, code: str, is_down: bool, text: str) -> None:
        """Process a `KeyInput`.

        While a key is held it may come down again and again, as keyboards repeat it. A view
        that leaves or falls silent releases each key that it held, with `is_down` False.
        """

    def on_layout(self, view: int, keys: Mapping[str, str]) -> None:
        """Process a `LayoutInput`."""

    def on_pad(self, view: int, axes: Sequence[float], buttons: Sequence[float]) -> None:
        """Process a `PadInput`; one of a view that leaves or falls silent has nothing pressed."""

    def on_sticks(
        self,
        view: int,
        translation: tuple[float, float, float],
        rotation: tuple[float, float],
        is_fine: bool,
        yaw_deg: float,
    ) -> None:
        """Process a `SticksInput`; a view that leaves or falls silent releases them: zeros."""

    def on_orbit(self, view: int, around_deg: float, higher_deg: float, zoom: float) -> None:
        """Process an `OrbitInput`."""

    def on_press(self, view: int, control: str) -> None:
        """Process a `PressInput`; any name."""

    def on_item(self, view: int, name: str) -> None:
        """Process an `ItemInput`; any name, the menu may have changed."""

    def on_text(self, view: int, name: str, value: str) -> None:
        """Process a `TextInput`; any name, the menu may have changed."""

    def on_frames(self, view: int, frames: Frames) -> None:
        """Process how smoothly a view draws, once a second."""

    def on_picture(self, view: int, task: str, share: float) -> None:
        """Process a `PictureProgress`."""

    def on_visibility(self, view: int, is_visible: bool) -> None:
        """Process a `Visibility`."""

    def on_silence(self, view: int) -> None:
        """Process that a view has been silent for so long that its picture must be frozen."""
