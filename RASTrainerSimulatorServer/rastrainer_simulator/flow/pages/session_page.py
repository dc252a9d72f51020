"""What all pages of the menus share: the session, its texts, and hints that press a control."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeVar

from rastrainer_simulator.flow.session.open_pages import Page, PageContent
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.inputs import ControlName
from rastrainer_simulator.presentation.screen import PRESS, Hint

T = TypeVar("T")


class SessionPage(Page):
    """A page that reads and changes the session; it stores only its own state."""

    def __init__(self, session: TrainingSession) -> None:
        self.session = session

    def back(self) -> None:
        self.session.pages.close()

    def say(self, key: str, **values: object) -> str:
        return self.session.texts.say(key, **values)

    def open_page(self, page: Callable[..., Page], *arguments: object) -> Callable[[], None]:
        return lambda: self.session.pages.open(page(self.session, *arguments))


Leave = Callable[[TrainingSession], object]
Show = Callable[..., PageContent]


class ShownPage(SessionPage):
    """A page without a state of its own: `show` makes what it shows now.

    `show` is given the page and the arguments; `leave` is called when the trainee goes back.
    """

    def __init__(
        self,
        name: str,
        show: Show,
        leave: Leave | None,
        pause_goes_back: bool,
        session: TrainingSession,
        *arguments: object,
    ) -> None:
        super().__init__(session)
        self.name, self.pause_goes_back = name, pause_goes_back
        self._show, self._leave, self._arguments = show, leave, arguments

    def content(self) -> PageContent:
        return self._show(self, *self._arguments)

    def back(self) -> None:
        if self._leave is None:
            super().back()
        else:
            self._leave(self.session)


def page_kind(
    name: str, leave: Leave | None = None, pause_goes_back: bool = False
) -> Callable[[Show], Callable[..., SessionPage]]:
    """Make a function that returns the content of a page one that makes this page."""
    return lambda show: partial(ShownPage, name, show, leave, pause_goes_back)


def stepped(options: Sequence[T], value: T, direction: int) -> T:
    """Return the next (1) or previous (−1) of some options, around the ends."""
    return options[(options.index(value) + direction) % len(options)]


def clickable_hint(session: TrainingSession, control: ControlName, key: str) -> Hint:
    return Hint(session.operator.label(control), session.texts.say(key), PRESS + control.value)
