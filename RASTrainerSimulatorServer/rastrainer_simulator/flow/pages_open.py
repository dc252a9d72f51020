"""Which pages are open, one over the other, and which item has the focus."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

from rastrainer_simulator.controls.control_name import ControlName
from rastrainer_simulator.flow.feedback import Happening
from rastrainer_simulator.flow.page import Page
from rastrainer_simulator.flow.screen import Item, ItemKind, Menu

_STEPS = {ControlName.LEFT: -1, ControlName.RIGHT: 1}
_MOVES = {ControlName.UP: -1, ControlName.DOWN: 1}


class OpenPages:
    """The open pages; none while the trainee works.

    Attributes:
        home: makes the page that all others lie over.
    """

    def __init__(self, happened: Callable[[Happening], None]) -> None:
        self.home: Callable[[], Page] | None = None
        self._happened = happened
        self._open: list[Page] = []
        self._focus: list[str] = []

    @property
    def top(self) -> Page | None:
        """The page that is shown."""
        return self._open[-1] if self._open else None

    def show(self, page: Page | None) -> None:
        """Close all pages and open one, or none."""
        while self._open:
            self.close()
        if page is not None:
            self.open(page)

    def show_start(self) -> None:
        """Close all pages but the first."""
        self.show(self.home())

    def open(self, page: Page) -> None:
        """Open a page over the others."""
        self._open.append(page)
        self._focus.append(page.first)

    def close(self) -> None:
        """Close the page that is shown."""
        if self._open:
            self._focus.pop()
            self._open.pop().closed()

    def replace(self, page: Page) -> None:
        """Show a page in place of the one that is shown."""
        self.close()
        self.open(page)

    def menu(self) -> Menu | None:
        """Return what is shown, with the focus."""
        if not self._open:
            return None
        menu = self.top.menu()
        return dataclasses.replace(menu, focus=self._focused(menu))

    def pressed(self, control: ControlName) -> None:
        """Take a control of the menus."""
        page = self.top
        if page is None or page.pressed(control):
            return
        if control in _MOVES:
            self.move(_MOVES[control])
        elif control in _STEPS:
            self._step(_STEPS[control])
        elif control is ControlName.ACCEPT:
            self.choose(self._focused(page.menu()))
        elif control is ControlName.BACK:
            self._happened(Happening.ACCEPT)
            page.back()
        elif control is ControlName.MENU:
            self._happened(Happening.ACCEPT)
            page.pressed_menu()

    def move(self, direction: int) -> None:
        """Move the focus to the next (1) or previous (−1) item, around the ends."""
        menu = self.top.menu()
        names = [item.name for item in menu.items if item.kind is not ItemKind.AXIS]
        if names:
            place = names.index(self._focused(menu)) + direction
            self._focus[-1] = names[place % len(names)]
            self._happened(Happening.FOCUS)

    def choose(self, name: str) -> None:
        """Choose an item: press a button, step a choice, go to a text."""
        item = self._item(name)
        if item is None:
            return
        self._focus[-1] = name
        if not item.is_enabled:
            self._happened(Happening.ERROR)
            return
        self._happened(Happening.ACCEPT)
        page = self.top
        if item.kind is ItemKind.CHOICE and page.steps_when_accepted:
            page.step(name, 1)
        else:
            page.accept(name)

    def write(self, name: str, value: str) -> None:
        """Put a value into a text item."""
        item = self._item(name)
        if item is not None and item.kind is ItemKind.TEXT:
            self._focus[-1] = name
            self.top.write(name, value)

    def text_item(self) -> Item | None:
        """Return the text item that has the focus, None where it is another."""
        if not self._open:
            return None
        item = self._item(self._focused(self.top.menu()))
        return item if item is not None and item.kind is ItemKind.TEXT else None

    def _step(self, direction: int) -> None:
        item = self._item(self._focused(self.top.menu()))
        if item is None or item.kind is not ItemKind.CHOICE:
            return
        if not item.is_enabled:
            self._happened(Happening.ERROR)
            return
        self._happened(Happening.FOCUS)
        self.top.step(item.name, direction)

    def _item(self, name: str) -> Item | None:
        items = self.top.menu().items if self._open else ()
        return next((item for item in items if item.name == name), None)

    def _focused(self, menu: Menu) -> str:
        """Return the item with the focus: the first that can be chosen, where it is gone."""
        items = [item for item in menu.items if item.kind is not ItemKind.AXIS]
        names = [item.name for item in items]
        if self._focus[-1] in names:
            return self._focus[-1]
        chosen = next((item.name for item in items if item.is_enabled), "")
        return chosen or (names[0] if names else "")
