"""Pages of rows, the stack of open pages, and the row that has the focus."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, ClassVar, Generic, Protocol, TypeVar

from rastrainer_simulator.input.inputs import ControlName, InputDevice
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent
from rastrainer_simulator.presentation.screen import (
    ControlsPicture,
    Fact,
    HeadSlices,
    ItemKind,
    Menu,
    MenuItem,
    ScoreTrend,
    Screen,
)

T = TypeVar("T")

_STEPS = {ControlName.LEFT: -1, ControlName.RIGHT: 1}
_MOVES = {ControlName.UP: -1, ControlName.DOWN: 1}


@dataclass(frozen=True)
class PageRow:
    """A line of a page with its actions.

    Attributes:
        accept: is called when a button is pressed, a text is chosen, or a choice accepted.
        step: moves a choice to its next (1) or previous (−1) option.
    """

    item: MenuItem
    accept: Callable[[], object]
    step: Callable[[int], object] = lambda _direction: None
    write: Callable[[str], object] = lambda _value: None


@dataclass(frozen=True)
class PageContent:
    """The content of a page; a part that it does not have is empty.

    Attributes:
        title: "" for the sentence "NAME.title".
        first: name of the row that has the focus when the page opens; "" is the first that can be
            chosen.
    """

    paragraphs: Sequence[str] = ()
    facts: Sequence[Fact] = ()
    rows: Sequence[PageRow] = ()
    title: str = ""
    picture: ControlsPicture = ""
    trend: ScoreTrend | None = None
    slices: HeadSlices | None = None
    first: str = ""


class PageOwner(Protocol):
    """The data that pages read and change: a trainee's session, or a rater's work."""

    pages: OpenPages

    def say(self, key: str, **values: object) -> str:
        """Return a sentence in the reader's language."""


S = TypeVar("S", bound=PageOwner)


class Page(Generic[S]):
    """A page of text, facts and rows, which stores only its own state.

    Attributes:
        arguments, values: what the functions of a `page_kind` are given; they may change values.
        focus: name of the row that has the focus.
        is_private: whether its rows are only for the views of who operates.
        pause_goes_back: whether the control that pauses, which opened the page, also closes it.
    """

    name: str = ""
    focus: str = ""
    is_private: ClassVar[bool] = False
    pause_goes_back: ClassVar[bool] = False

    def __init__(self, session: S, *arguments: Any, **values: Any) -> None:
        self.session, self.arguments, self.values = session, arguments, values

    def content(self) -> PageContent:
        raise NotImplementedError

    def say(self, key: str, **values: object) -> str:
        return self.session.say(key, **values)

    def back(self) -> None:
        self.session.pages.close()

    def set_value(self, name: str, value: Any) -> None:
        self.values[name] = value

    def open_page(self, page: Callable[..., Page[Any]], *arguments: object) -> Callable[[], None]:
        return lambda: self.session.pages.open(page(self.session, *arguments))

    def button(
        self, name: str, accept: Callable[[], object] | None = None, label: str = "", **others: Any
    ) -> PageRow:
        """Return a button; without a function it goes back."""
        item = MenuItem(name, label or self.say(f"{self.name}.{name}"), **others)
        return PageRow(item, accept or self.back)

    def choice(
        self,
        name: str,
        options: Sequence[T],
        chosen: T,
        shown: str,
        choose: Callable[[T], object] | None = None,
        label: str = "",
        **others: Any,
    ) -> PageRow:
        """Return a choice, around the ends; from a value that is no option it goes to an end.

        Without a function, it is among the page's own values.
        """
        choose = choose or partial(self.set_value, name)

        def step(direction: int) -> None:
            before = -1 if direction > 0 else 0
            place = options.index(chosen) if chosen in options else before
            choose(options[(place + direction) % len(options)])

        row = self.button(name, lambda: step(1), label, kind=ItemKind.CHOICE, value=shown, **others)
        return dataclasses.replace(row, step=step)

    def screen(self) -> Screen | None:
        """Return a screen without a menu; None if the page has a menu."""
        return None

    def input_pressed(self, device: InputDevice, name: str) -> bool:  # noqa: ARG002
        return False

    def pressed(self, control: ControlName) -> bool:  # noqa: ARG002
        return False

    def is_over(self) -> bool:
        return False

    def advance(self, dt: float) -> None:  # noqa: ARG002
        if self.is_over():
            self.back()

    def closed(self) -> None:
        """Clean up: the page is no longer open."""


def page_kind(name: str, **others: Any) -> Callable[[Callable[..., PageContent]], type[Page[Any]]]:
    """Return a decorator that makes a kind of page of the function that returns its content.

    `others` are members of `Page` that differ. Each function is given the page, what the method is
    given, the page's arguments, and its values by their names.
    """

    def method(function: Callable[..., Any]) -> Callable[..., Any]:
        return lambda page, *given: function(page, *given, *page.arguments, **page.values)

    def kind(show: Callable[..., PageContent]) -> type[Page[Any]]:
        members = {"content": show, **others}
        methods = {key: method(each) if callable(each) else each for key, each in members.items()}
        return type(name, (Page,), {"name": name, **methods})

    return kind


GRACE_S = 0.7
"""How long a page that opens automatically has no focus: presses meant for the arm do nothing."""


@dataclass(eq=False)
class OpenPages:
    """The open pages; none while the trainee works.

    A page that opens automatically ignores presses for `GRACE_S` seconds of the simulator's clock;
    clicks on its rows count at once.

    Attributes:
        home: makes the page that all others lie over.
    """

    _happened: Callable[[FeedbackEvent], None]
    home: Callable[[], Page[Any]] = field(init=False)
    _open: list[Page[Any]] = field(default_factory=list)
    _grace_s: float = 0.0

    @property
    def top(self) -> Page[Any] | None:
        return self._open[-1] if self._open else None

    def show(self, page: Page[Any] | None, ignore_input_briefly: bool = False) -> None:
        while self._open:
            self.close()
        if page is not None:
            self.open(page, ignore_input_briefly)

    def advance(self, dt: float) -> None:
        self._grace_s -= dt
        if self.top is not None:
            self.top.advance(dt)

    def show_start(self) -> None:
        self.show(self.home())

    def open(self, page: Page[Any], ignore_input_briefly: bool = False) -> None:
        """Open a page over the others; with a grace time where it opens automatically."""
        page.focus = page.content().first
        self._grace_s = GRACE_S if ignore_input_briefly else 0.0
        self._open.append(page)

    def close(self) -> None:
        if self._open:
            self._open.pop().closed()

    def replace(self, page: Page[Any]) -> None:
        self.close()
        self.open(page)

    def menu(self) -> Menu | None:
        if self.top is None:
            return None
        shown = self.top.content()
        return Menu(
            self.top.name,
            shown.title or self.top.say(f"{self.top.name}.title"),
            tuple(shown.paragraphs),
            tuple(shown.facts),
            tuple(row.item for row in shown.rows),
            self._focused(shown.rows),
            shown.picture,
            shown.trend,
            shown.slices,
        )

    def pressed(self, control: ControlName) -> None:
        page = self.top
        if page is None or self._grace_s > 0.0 or page.pressed(control):
            return
        if control in _MOVES:
            self.move(_MOVES[control])
        elif control in _STEPS:
            row = self._row()
            if row is not None and row.item.kind is ItemKind.CHOICE:
                self._act(row, FeedbackEvent.FOCUS, partial(row.step, _STEPS[control]))
        elif control is ControlName.ACCEPT:
            self.choose(self._focused(page.content().rows))
        elif control is ControlName.PAUSE and page.pause_goes_back:
            page.back()
        elif control in (ControlName.BACK, ControlName.MENU):
            self._happened(FeedbackEvent.ACCEPT)
            page.back()

    def move(self, direction: int) -> None:
        if self.top is None:
            return
        rows = self.top.content().rows
        names = [row.item.name for row in rows if row.item.kind is not ItemKind.AXIS]
        if names:
            place = names.index(self._focused(rows)) + direction
            self.focus(names[place % len(names)])
            self._happened(FeedbackEvent.FOCUS)

    def focus(self, name: str) -> None:
        if self.top is not None:
            self.top.focus = name

    def choose(self, name: str) -> None:
        row = self._row(name)
        if row is not None:
            self.focus(name)
            self._act(row, FeedbackEvent.ACCEPT, row.accept)

    def write(self, name: str, value: str) -> None:
        row = self._row(name)
        if row is not None and row.item.kind is ItemKind.TEXT:
            self.focus(name)
            row.write(value)

    def typed(self, code: str, text: str) -> tuple[str, str] | None:
        """Return the text that has the focus, and its value after a key; None without one."""
        row, is_deleting = self._row(), code == "Backspace"
        if row is None or row.item.kind is not ItemKind.TEXT:
            return None
        if not is_deleting and (len(text) != 1 or not text.isprintable()):
            return None
        value = row.item.value
        return row.item.name, value[:-1] if is_deleting else value + text

    def _act(self, row: PageRow, felt: FeedbackEvent, act: Callable[[], object]) -> None:
        self._happened(felt if row.item.is_enabled else FeedbackEvent.ERROR)
        if row.item.is_enabled:
            act()

    def _row(self, name: str | None = None) -> PageRow | None:
        """Return a row by its name; without a name, the row that has the focus."""
        rows = () if self.top is None else self.top.content().rows
        name = self._focused(rows) if name is None else name
        return next((row for row in rows if row.item.name == name), None)

    def _focused(self, rows: Sequence[PageRow]) -> str:
        """Return the row with the focus: the first that can be chosen, where it is gone."""
        if self._grace_s > 0.0:
            return ""
        items = [row.item for row in rows if row.item.kind is not ItemKind.AXIS]
        names = [item.name for item in items]
        if self.top is not None and self.top.focus in names:
            return self.top.focus
        chosen = next((item.name for item in items if item.is_enabled), "")
        return chosen or (names[0] if names else "")
