"""The errors of a scored trial's touches, drawn on the head."""

from __future__ import annotations

from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.input.control_name import ControlName
from rastrainer_simulator.net.views.screen import (
    ErrorArrow,
    Hint,
    Menu,
    Screen,
    ScreenMessage,
    Tone,
)
from rastrainer_simulator.vectors import Vector, add, length, scale, subtract

GOOD_MM = 2.0
POOR_MM = 4.0
"""Errors up to the first are good, from the second on they are poor: what frameless stereotaxy
reaches in the clinic lies between them."""
LONGER = 5.0
"""An error of a millimetre would hardly be seen."""


class ErrorsPage(SessionPage):
    """Shows the head without a menu, with an arrow from each fiducial toward its touch."""

    name = "errors"

    def menu(self) -> Menu:
        """Return what a view that draws no arrows would show."""
        return Menu(self.name, self._title, items=(self.button("back"),))

    def screen(self) -> Screen:
        """Return the arrows; they show the true errors, which the score has already revealed."""
        session = self.session
        touches = session.training.touches if session.training.result is not None else ()
        return Screen(
            instruction=ScreenMessage(self._title),
            hints=(Hint(session.label(ControlName.BACK), self.say("hint.result")),),
            language=session.preferences.language,
            errors=tuple(error_arrow(session.fiducial(t.label), t.position) for t in touches),
        )

    @property
    def _title(self) -> str:
        return self.say("errors.title", longer=LONGER, good=GOOD_MM, poor=POOR_MM)

    def accept(self, item: str) -> None:  # noqa: ARG002
        """Go back to the result."""
        self.back()


def error_arrow(fiducial: Vector, touch: Vector) -> ErrorArrow:
    """Return the arrow from a fiducial toward its touch, both in World, m."""
    error = subtract(touch, fiducial)
    tone = error_tone(MM_PER_M * length(error))
    return ErrorArrow(fiducial, add(fiducial, scale(error, LONGER)), tone)


def error_tone(error_mm: float) -> Tone:
    """Return how good a touch is."""
    tone = Tone.ERROR if error_mm >= POOR_MM else Tone.WARNING
    return Tone.GOOD if error_mm <= GOOD_MM else tone
