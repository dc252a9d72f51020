"""What a page is, which pages are open one over the other, and which item has the focus."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import ClassVar

from rastrainer_simulator.input.inputs import ControlName, InputDevice
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent
from rastrainer_simulator.presentation.screen import ItemKind, Menu, MenuItem, Screen

_STEPS = {ControlName.LEFT: -1, ControlName.RIGHT: 1}
_MOVES = {ControlName.UP: -1, ControlName.DOWN: 1}


class Page:
    """What is shown, and what its items do.

    Attributes:
        name: of the menu.
        steps_when_accepted: whether accepting a choice goes to its next option.
        first: name of the item that has the focus at first; "" is the first that can be chosen.
        is_private: whether its items are only for the views of who operates.
    """

    name: ClassVar[str] = ""
    steps_when_accepted: ClassVar[bool] = True
    first: str = ""
    is_private: ClassVar[bool] = False

    def menu(self) -> Menu:
        """Return what is shown, without a focus."""
        raise NotImplementedError

    def screen(self) -> Screen | None:
        """Return what is read in place of a menu; None where the menu is."""
        return None

    def accept(self, item: str) -> None:
        """Handle the choice of an item."""

    def step(self, item: str, direction: int) -> None:
        """Move a choice to its next (1) or previous (−1) option."""

    def write(self, item: str, value: str) -> None:
        """Handle a new value of a text item."""

    def back(self) -> None:
        """Leave the page, as the trainee wants."""
        raise NotImplementedError

    def pressed_menu(self) -> None:
        """Handle a press of the control for the menu."""
        self.back()

    def input_pressed(self, device: InputDevice, name: str) -> bool:  # noqa: ARG002
        return False

    def pressed(self, control: ControlName) -> bool:  # noqa: ARG002
        return False

    def advance(self, dt: float) -> None:
        """Advance by `dt` seconds."""

    def closed(self) -> None:
        """Clean up: the page is no longer open."""


GRACE_S = 0.7
"""How long a page that opens automatically has no focus: presses meant for the arm do nothing."""


class OpenPages:
    """The open pages; none while the trainee works.

    A page that opens automatically ignores presses for `GRACE_S` seconds of the simulator's clock;
    clicks on its items count at once.

    Attributes:
        home: makes the page that all others lie over.
    """

    def __init__(self, happened: Callable[[FeedbackEvent], None]) -> None:
        self.home: Callable[[], Page] = _no_home
        self._happened = happened
        self._open: list[Page] = []
        self._focus: list[str] = []
        self._grace_s = 0.0

    @property
    def top(self) -> Page | None:
        return self._open[-1] if self._open else None

    def show(self, page: Page | None, has_grace: bool = False) -> None:
        """Close all pages and open one, or none."""
        while self._open:
            self.close()
        if page is not None:
            self.open(page, has_grace)

    def advance(self, dt: float) -> None:
        """Advance the page that is shown by `dt` seconds."""
        self._grace_s -= dt
        if self.top is not None:
            self.top.advance(dt)

    def show_start(self) -> None:
        """Close all pages except the first."""
        self.show(self.home())

    def open(self, page: Page, has_grace: bool = False) -> None:
        """Open a page over the others; with a grace time where it opens automatically."""
        self._grace_s = GRACE_S if has_grace else 0.0
        self._open.append(page)
        self._focus.append(page.first)

    def close(self) -> None:
        if self._open:
            self._focus.pop()
            self._open.pop().closed()

    def replace(self, page: Page) -> None:
        """Show a page in place of the one that is shown."""
        self.close()
        self.open(page)

    def menu(self) -> Menu | None:
        """Return what is shown, with the focus."""
        page = self.top
        if page is None:
            return None
        menu = page.menu()
        return dataclasses.replace(menu, focus=self._focused(menu))

    def pressed(self, control: ControlName) -> None:
        """Process a control of the menus."""
        page = self.top
        if page is None or self._grace_s > 0.0 or page.pressed(control):
            return
        if control in _MOVES:
            self.move(_MOVES[control])
        elif control in _STEPS:
            self._step(_STEPS[control])
        elif control is ControlName.ACCEPT:
            self.choose(self._focused(page.menu()))
        elif control is ControlName.BACK:
            self._happened(FeedbackEvent.ACCEPT)
            page.back()
        elif control is ControlName.MENU:
            self._happened(FeedbackEvent.ACCEPT)
            page.pressed_menu()

    def move(self, direction: int) -> None:
        """Move the focus to the next (1) or previous (−1) item, around the ends."""
        page = self.top
        if page is None:
            return
        menu = page.menu()
        names = [item.name for item in menu.items if item.kind is not ItemKind.AXIS]
        if names:
            place = names.index(self._focused(menu)) + direction
            self._focus[-1] = names[place % len(names)]
            self._happened(FeedbackEvent.FOCUS)

    def focus(self, name: str) -> None:
        if self._focus:
            self._focus[-1] = name

    def choose(self, name: str) -> None:
        """Choose an item: press a button, step a choice, go to a text."""
        page, item = self.top, self._item(name)
        if page is None or item is None:
            return
        self._focus[-1] = name
        if not item.is_enabled:
            self._happened(FeedbackEvent.ERROR)
            return
        self._happened(FeedbackEvent.ACCEPT)
        if item.kind is ItemKind.CHOICE and page.steps_when_accepted:
            page.step(name, 1)
        else:
            page.accept(name)

    def write(self, name: str, value: str) -> None:
        """Put a value into a text item."""
        page, item = self.top, self._item(name)
        if page is not None and item is not None and item.kind is ItemKind.TEXT:
            self._focus[-1] = name
            page.write(name, value)

    def typed(self, code: str, text: str) -> tuple[str, str] | None:
        """Return the text item that has the focus, and its value after a key; None without one."""
        item, is_deleting = self._focused_item(), code == "Backspace"
        if item is None or item.kind is not ItemKind.TEXT:
            return None
        if not is_deleting and (len(text) != 1 or not text.isprintable()):
            return None
        return item.name, item.value[:-1] if is_deleting else item.value + text

    def _step(self, direction: int) -> None:
        page, item = self.top, self._focused_item()
        if page is None or item is None or item.kind is not ItemKind.CHOICE:
            return
        if not item.is_enabled:
            self._happened(FeedbackEvent.ERROR)
            return
        self._happened(FeedbackEvent.FOCUS)
        page.step(item.name, direction)

    def _focused_item(self) -> MenuItem | None:
        return None if self.top is None else self._item(self._focused(self.top.menu()))

    def _item(self, name: str) -> MenuItem | None:
        items = () if self.top is None else self.top.menu().items
        return next((item for item in items if item.name == name), None)

    def _focused(self, menu: Menu) -> str:
        """Return the item with the focus: the first that can be chosen, where it is gone."""
        if self._grace_s > 0.0:
            return ""
        items = [item for item in menu.items if item.kind is not ItemKind.AXIS]
        names = [item.name for item in items]
        if self._focus[-1] in names:
            return self._focus[-1]
        chosen = next((item.name for item in items if item.is_enabled), "")
        return chosen or (names[0] if names else "")


def _no_home() -> Page:
    raise RuntimeError("There is no home page yet.")
