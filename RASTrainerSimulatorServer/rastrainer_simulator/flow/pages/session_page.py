"""What all pages of the menus share: the session, its texts, and hints that press a control."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
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


@dataclass(frozen=True)
class PageKind:
    """A kind of page that has no state.

    Attributes:
        show: makes what a page shows now; it is given the page, and the arguments of the call.
        leave: is called when the trainee goes back; None closes the page.
    """

    name: str
    show: Callable[..., PageContent]
    leave: Callable[[TrainingSession], object] | None = None
    pause_goes_back: bool = False

    def __call__(self, session: TrainingSession, *arguments: object) -> SessionPage:
        return _ShownPage(session, self, arguments)


def page_kind(
    name: str,
    leave: Callable[[TrainingSession], object] | None = None,
    pause_goes_back: bool = False,
) -> Callable[[Callable[..., PageContent]], PageKind]:
    """Make a function that returns the content of a page the kind of this page."""
    return lambda show: PageKind(name, show, leave, pause_goes_back)


class _ShownPage(SessionPage):
    """A page of a `PageKind`."""

    def __init__(
        self, session: TrainingSession, kind: PageKind, arguments: Sequence[object]
    ) -> None:
        super().__init__(session)
        self._kind, self._arguments = kind, arguments
        self.name, self.pause_goes_back = kind.name, kind.pause_goes_back

    def content(self) -> PageContent:
        return self._kind.show(self, *self._arguments)

    def back(self) -> None:
        if self._kind.leave is None:
            super().back()
        else:
            self._kind.leave(self.session)


def stepped(options: Sequence[T], value: T, direction: int) -> T:
    """Return the next (1) or previous (−1) of some options, around the ends."""
    return options[(options.index(value) + direction) % len(options)]


def clickable_hint(session: TrainingSession, control: ControlName, key: str) -> Hint:
    return Hint(session.operator.label(control), session.texts.say(key), PRESS + control.value)
