"""What the training is about, which control does what, and a page to try the controls."""

from __future__ import annotations

from rastrainer_simulator.flow.pages.bindings import BindingsPage
from rastrainer_simulator.flow.pages.experiment import ExperimentPage
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.inputs import ROTATION, TRANSLATION, ControlName, InputDevice
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent
from rastrainer_simulator.presentation.screen import Fact, ItemKind, Menu, MenuItem

SHEETS = 3

_SHOWN = (
    ("move_along", (ControlName.MOVE_FORWARD, ControlName.MOVE_BACK)),
    ("move_across", (ControlName.MOVE_LEFT, ControlName.MOVE_RIGHT)),
    ("move_vertically", (ControlName.MOVE_UP, ControlName.MOVE_DOWN)),
    ("fine", (ControlName.FINE,)),
    ("touch", (ControlName.TOUCH,)),
    ("undo", (ControlName.UNDO,)),
    ("best_view", (ControlName.BEST_VIEW,)),
    ("turn_view", (ControlName.VIEW_LEFT, ControlName.VIEW_RIGHT)),
    ("tilt_view", (ControlName.VIEW_HIGHER, ControlName.VIEW_LOWER)),
    ("zoom_view", (ControlName.VIEW_NEARER, ControlName.VIEW_FARTHER)),
    ("camera", (ControlName.CAMERA,)),
    ("pause", (ControlName.PAUSE,)),
    ("menu", (ControlName.MENU,)),
)
SHOWN = 4
"""Inputs that are remembered."""


class IntroductionPage(SessionPage):
    """A few sheets of text; the last leads to the controls."""

    name = "introduction"
    first = "next"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self._sheet = 1

    def menu(self) -> Menu:
        """Return the sheet."""
        return Menu(
            self.name,
            self.say(f"introduction.title.{self._sheet}"),
            (
                self.say(f"introduction.text.{self._sheet}"),
                self.say("introduction.sheet", sheet=self._sheet, sheets=SHEETS),
            ),
            items=(self.button("next"), self.button("skip"), self.button("back")),
        )

    def accept(self, item: str) -> None:
        """Turn the sheet."""
        if item == "back":
            self.back()
        elif item == "next" and self._sheet < SHEETS:
            self._sheet += 1
        else:
            self.session.pages.replace(ControlsPage(self.session, leads_on=True))

    def back(self) -> None:
        """Go back a sheet."""
        if self._sheet == 1:
            self.session.pages.close()
        else:
            self._sheet -= 1


class ControlsPage(SessionPage):
    """Which input does what, on whatever the reader has in their hands."""

    name = "controls"

    def __init__(self, session: TrainingSession, leads_on: bool = False) -> None:
        super().__init__(session)
        self._leads_on = leads_on

    def menu(self) -> Menu:
        """Return the list of the controls."""
        session = self.session
        # Two ways of a stick tell which one it is; a key has only one.
        most = len(ControlName) if session.operator.kind is InputDevice.KEYBOARD else 2
        facts = tuple(
            Fact(
                self.say(f"controls.{key}"),
                " / ".join(map(session.operator.label, controls[:most])),
            )
            for key, controls in _SHOWN
        )
        items = (*(["next"] if self._leads_on else []), "test", "rebind", "back")
        return Menu(
            self.name,
            self.say("controls.title"),
            (self.say("controls.text"),),
            facts,
            tuple(self.button(item) for item in items),
            picture=session.operator.picture,
        )

    def accept(self, item: str) -> None:
        """Continue, try the controls or change them."""
        pages = self.session.pages
        if item == "next":
            self.session.has_read_introduction = True
            pages.replace(ExperimentPage(self.session))
        elif item == "back":
            self.back()
        else:
            pages.open((PadTestPage if item == "test" else BindingsPage)(self.session))


class PadTestPage(SessionPage):
    """Shows what arrives. Every input but the menu's is only shown; the menu's leaves."""

    name = "test"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self._pressed: list[tuple[InputDevice, str]] = []

    def menu(self) -> Menu:
        """Return the sticks' positions and the last inputs."""
        held = self.session.held
        positions = (*held.translation, *held.rotation)
        axes = tuple(
            MenuItem(f"axis{number}", self._axis(pair), ItemKind.AXIS, f"{position:.2f}", False)
            for number, (pair, position) in enumerate(
                zip((*TRANSLATION, *ROTATION), positions, strict=True)
            )
        )
        fine = Fact(self.say("control.fine"), self.say("test.yes" if held.fine else "test.no"))
        facts = tuple(Fact(*self._input(*pressed)) for pressed in self._pressed)
        leave = self.session.operator.label(ControlName.MENU)
        return Menu(
            self.name,
            self.say("test.title"),
            (self.say("test.text", menu=leave),),
            (fine, *facts),
            (*axes, self.button("back")),
        )

    def accept(self, item: str) -> None:
        """Go back."""
        if item == "back":
            self.back()

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        """Show an input, and let it be felt."""
        if name in self.session.bindings.table(device)[ControlName.MENU]:
            return False
        self._pressed = [(device, name), *self._pressed][:SHOWN]
        self.session.happened(FeedbackEvent.TEST)
        return True

    def _axis(self, pair: tuple[ControlName, ControlName]) -> str:
        return " / ".join(self.say(f"control.{control.value}") for control in pair)

    def _input(self, device: InputDevice, name: str) -> tuple[str, str]:
        table = self.session.bindings.table(device)
        works = [control for control, inputs in table.items() if name in inputs]
        names = self.session.texts.listed(self.say(f"control.{each.value}") for each in works)
        return self.session.operator.input_label(device, name), names or self.say("test.nothing")
