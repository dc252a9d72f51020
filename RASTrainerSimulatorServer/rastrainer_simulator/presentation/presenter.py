"""The presenter between the views and the simulation: it makes screens and takes input."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer_simulator.loop.results import Subscribers
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent
from rastrainer_simulator.presentation.messages import (
    Feedback,
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
    """The source that drives the arm, as people read it; "" while no one drives.

    `view` is where its input comes from; None for a gamepad at the simulator.
    """

    holder: str = ""
    view: int | None = None


ViewUpdate = Screen | Feedback | Control


@dataclass(frozen=True)
class TraceGuidance:
    """How a trainee who traces the skin is guided: by paint, and where to draw next.

    `covered_mm` is the distance around the traced points that is painted on the skin; 0 for none.
    """

    covered_mm: float = 0.0
    next_place: SkinPlace | None = None


class Presenter:
    """Makes what the view server shows, and takes the input of views; ignores it by default.

    Everything is called in the event loop's thread, subscribers too; every call returns at once.
    Values have been checked: numbers are finite and within their range, texts short and printable,
    `view` is the number of a view that has joined.

    Attributes:
        updates: each new screen, feedback and holder of the control.
    """

    control = Control()

    def __init__(self) -> None:
        self.updates: Subscribers[ViewUpdate] = Subscribers()
        self.screen = Screen()
        self._feedback_count = 0

    def show(self, screen: Screen) -> None:
        if screen != self.screen:
            self.screen = screen
            self.updates.publish(screen)

    def happened(self, what: FeedbackEvent, volume: float = 1.0) -> None:
        """Have the views play the sound and the vibration of an event."""
        self._feedback_count += 1
        number, rumble_ms = self._feedback_count, round(1000.0 * what.seconds)
        self.updates.publish(
            Feedback(number, what.value, what.sound, volume, what.rumble, rumble_ms)
        )

    def pictures(self, now: SimulationState) -> Pictures:
        raise NotImplementedError

    def ghost(self, now: SimulationState) -> tuple[np.ndarray, ...] | None:  # noqa: ARG002
        """Return the poses of the ghost next to the arm in a state, in the order of `GHOST_BODIES`.

        Each is (4, 4) float, to World, m; None without a ghost.
        """
        return None

    def trace_guidance(self, now: SimulationState) -> TraceGuidance:  # noqa: ARG002
        return TraceGuidance()

    def seat(self) -> Seat:
        """Return the seat as a teacher's board shows it; empty while no one trains."""
        return Seat()

    def instruct(self, order: InstructorOrder, text: str) -> str:
        """Carry out an order of a teacher who knows the PIN; return why it is impossible, or "".

        `text` is the sentence of `InstructorOrder.SAY`, else "".
        """
        raise NotImplementedError

    def view_joined(self, view: int, hello: Hello) -> None:
        """Register a view."""

    def view_left(self, view: int) -> None:
        """Forget a view; its held inputs have been released before."""

    def receive(self, view: int, kind: str, *values: object) -> None:
        """Process a message of a view, with the values of its fields; ignored by default.

        It goes to the method of its type, such as `on_key` for `KeyInput`. A key that is
        held may come down again and again, as keyboards repeat it. A view that leaves or falls
        silent releases everything: each key comes up, a pad has nothing pressed, sticks are at
        zero. The `kind` "silence" says that a view has been silent for so long that its picture
        must be frozen.
        """
        process = getattr(self, f"on_{kind}", None)
        if process is not None:
            process(view, *values)
