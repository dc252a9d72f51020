"""Try the controls out: every stick and button is shown as it is moved."""

from __future__ import annotations

from rastrainer_simulator.controls.control_name import ROTATION, TRANSLATION, ControlName
from rastrainer_simulator.controls.inputs import Device
from rastrainer_simulator.flow.feedback import Happening
from rastrainer_simulator.flow.page import Page
from rastrainer_simulator.flow.screen import Fact, Item, ItemKind, Menu
from rastrainer_simulator.flow.session import Session

SHOWN = 4
"""Inputs that are remembered."""


class PadTestPage(Page):
    """Shows what arrives. Every input but the menu's is only shown; the menu's leaves."""

    name = "test"

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._pressed: list[tuple[Device, str]] = []

    def menu(self) -> Menu:
        """Return the sticks' positions and the last inputs."""
        held = self.session.held
        positions = (*held.translation, *held.rotation)
        axes = tuple(
            Item(f"axis{number}", self._axis(pair), ItemKind.AXIS, f"{position:.2f}", False)
            for number, (pair, position) in enumerate(
                zip((*TRANSLATION, *ROTATION), positions, strict=True)
            )
        )
        fine = Fact(self.say("control.fine"), self.say("test.yes" if held.fine else "test.no"))
        facts = tuple(Fact(*self._input(*pressed)) for pressed in self._pressed)
        leave = self.session.label(ControlName.MENU)
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

    def input_pressed(self, device: Device, name: str) -> bool:
        """Show an input, and let it be felt."""
        if name in self.session.bindings.table(device)[ControlName.MENU]:
            return False
        self._pressed = [(device, name), *self._pressed][:SHOWN]
        self.session.happened(Happening.TEST)
        return True

    def _axis(self, pair: tuple[ControlName, ControlName]) -> str:
        return " / ".join(self.say(f"control.{control.value}") for control in pair)

    def _input(self, device: Device, name: str) -> tuple[str, str]:
        table = self.session.bindings.table(device)
        works = [control for control, inputs in table.items() if name in inputs]
        names = ", ".join(self.say(f"control.{control.value}") for control in works)
        return self.session.input_label(device, name), names or self.say("test.nothing")
