"""The errors of a scored trial's touches, drawn on the head."""

from __future__ import annotations

from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.input.inputs import ControlName, SourceKind
from rastrainer_simulator.presentation.screen import (
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
STEP_DEG = 10.0
"""By so much each press turns the view; held inputs repeat."""
_TURNS = {
    ControlName.LEFT: (-STEP_DEG, 0.0),
    ControlName.RIGHT: (STEP_DEG, 0.0),
    ControlName.UP: (0.0, STEP_DEG),
    ControlName.DOWN: (0.0, -STEP_DEG),
}
"""Around the head to the right, and higher, degrees."""
LONGER = 5.0
"""An error of a millimeter would hardly be seen."""


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
        back = Hint(session.operator.label(ControlName.BACK), self.say("hint.result"), "back")
        hints: tuple[Hint, ...] = (back,)
        if not session.operator.is_one_of((SourceKind.XR,)):
            # In a headset one looks around with the head.
            pairs = (ControlName.LEFT, ControlName.RIGHT), (ControlName.UP, ControlName.DOWN)
            turn = self.say("hint.turn_view")
            hints = (*(Hint(session.operator.pair_label(*pair), turn) for pair in pairs), back)
        return Screen(
            instruction=ScreenMessage(self._title),
            hints=hints,
            language=session.preferences.language,
            errors=tuple(error_arrow(session.fiducial(t.label), t.position) for t in touches),
        )

    def pressed(self, control: ControlName) -> bool:
        """Turn the view around the head."""
        if control not in _TURNS:
            return False
        session = self.session
        camera = session.scenario.cameras[session.state.camera]
        session.view.control.turn(camera, *_TURNS[control], 1.0)
        return True

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
