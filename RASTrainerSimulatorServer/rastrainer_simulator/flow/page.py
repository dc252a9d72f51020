"""One page of the menus."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from rastrainer_simulator.flow.screen import Item, ItemKind, Menu, Screen

if TYPE_CHECKING:
    from rastrainer_simulator.controls.control_name import ControlName
    from rastrainer_simulator.controls.inputs import Device
    from rastrainer_simulator.flow.session import Session


class Page:
    """What a page shows, and what its items do. A page keeps only what belongs to itself.

    Attributes:
        name: of the menu.
        steps_when_accepted: whether accepting a choice goes to its next option.
        first: name of the item that has the focus at first; "" is the first that can be chosen.
    """

    name: ClassVar[str] = ""
    steps_when_accepted: ClassVar[bool] = True
    first: str = ""

    def __init__(self, session: Session) -> None:
        self.session = session

    def menu(self) -> Menu:
        """Return what is shown, without a focus."""
        raise NotImplementedError

    def screen(self) -> Screen | None:
        """Return what is read in place of a menu; None where the menu is."""
        return None

    def accept(self, item: str) -> None:
        """An item that can be chosen was."""

    def step(self, item: str, direction: int) -> None:
        """A choice goes to its next (1) or previous (−1) option."""

    def write(self, item: str, value: str) -> None:
        """A text item has another value."""

    def back(self) -> None:
        """The trainee wants to leave."""
        self.session.pages.close()

    def pressed_menu(self) -> None:
        """The control for the menu was pressed."""
        self.back()

    def input_pressed(self, device: Device, name: str) -> bool:  # noqa: ARG002
        """An input was pressed; return whether the page wants nothing more to come of it."""
        return False

    def pressed(self, control: ControlName) -> bool:  # noqa: ARG002
        """A control was pressed; return whether that was all."""
        return False

    def advance(self, dt: float) -> None:
        """Go on for `dt` seconds."""

    def closed(self) -> None:
        """It is not open any more."""

    def say(self, key: str, **values: object) -> str:
        """Return a sentence in the chosen language."""
        return self.session.texts.say(key, **values)

    def button(self, name: str, label: str = "", **others: object) -> Item:
        """Return a button; its label is the page's text of that name."""
        return Item(name, label or self.say(f"{self.name}.{name}"), **others)

    def choice(self, name: str, value: str, **others: object) -> Item:
        """Return a choice; its label is the page's text of that name."""
        return self.button(name, kind=ItemKind.CHOICE, value=value, **others)
