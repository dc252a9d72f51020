"""What the training is about, and which control does what."""

from __future__ import annotations

from rastrainer_simulator.controls.control_name import ControlName
from rastrainer_simulator.controls.inputs import Device
from rastrainer_simulator.flow.page import Page
from rastrainer_simulator.flow.pages.bindings import BindingsPage
from rastrainer_simulator.flow.pages.experiment import ExperimentPage
from rastrainer_simulator.flow.pages.pad_test import PadTestPage
from rastrainer_simulator.flow.screen import Fact, Menu
from rastrainer_simulator.flow.session import Session

SHEETS = 3

_SHOWN = (
    (
        "move_horizontally",
        (
            ControlName.MOVE_FORWARD,
            ControlName.MOVE_LEFT,
            ControlName.MOVE_BACK,
            ControlName.MOVE_RIGHT,
        ),
    ),
    ("move_vertically", (ControlName.MOVE_UP, ControlName.MOVE_DOWN)),
    ("fine", (ControlName.FINE,)),
    ("touch", (ControlName.TOUCH,)),
    ("undo", (ControlName.UNDO,)),
    ("camera", (ControlName.CAMERA,)),
    ("pause", (ControlName.PAUSE,)),
    ("menu", (ControlName.MENU,)),
)


class IntroductionPage(Page):
    """A few sheets of text; the last leads to the controls."""

    name = "introduction"
    first = "next"

    def __init__(self, session: Session, sheet: int = 1) -> None:
        super().__init__(session)
        self._sheet = sheet

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


class ControlsPage(Page):
    """Which input does what, on whatever the reader has in their hands."""

    name = "controls"

    def __init__(self, session: Session, leads_on: bool = False) -> None:
        super().__init__(session)
        self._leads_on = leads_on

    def menu(self) -> Menu:
        """Return the list of the controls."""
        session = self.session
        # Two ways of a stick tell which one it is; a key has only one.
        most = len(ControlName) if session.device is Device.KEYBOARD else 2
        facts = tuple(
            Fact(self.say(f"controls.{key}"), " / ".join(map(session.label, controls[:most])))
            for key, controls in _SHOWN
        )
        items = ("next",) if self._leads_on else ()
        items += ("test", "rebind", "back")
        return Menu(
            self.name,
            self.say("controls.title"),
            (self.say("controls.text"),),
            facts,
            tuple(self.button(item) for item in items),
            picture="controls",
        )

    def accept(self, item: str) -> None:
        """Go on, or look closer."""
        pages = self.session.pages
        if item == "next":
            self.session.has_read_introduction = True
            pages.replace(ExperimentPage(self.session))
        elif item == "back":
            self.back()
        else:
            pages.open((PadTestPage if item == "test" else BindingsPage)(self.session))
