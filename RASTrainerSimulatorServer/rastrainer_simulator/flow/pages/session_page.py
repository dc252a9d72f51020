"""What all pages of the menus share: the session, its texts, and hints that press a control."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rastrainer_simulator.flow.session.open_pages import Page, PageContent
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.inputs import ControlName, InputDevice
from rastrainer_simulator.presentation.screen import PRESS, Hint


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
    """A kind of page: functions of the page, its arguments and its values.

    Attributes:
        show: returns the content.
        leave: does what going back does; closes the page by default.
        advance: also given the seconds since it was called last, after the page.
        take_input: also given a device and the name of its input, after the page; returns whether
            the input has no other function.
    """

    name: str
    show: Callable[..., PageContent]
    leave: Callable[..., object] = lambda page, *_arguments, **_values: page.session.pages.close()
    advance: Callable[..., object] = lambda *_arguments, **_values: None
    take_input: Callable[..., bool] = lambda *_arguments, **_values: False
    pause_goes_back: bool = False

    def __call__(self, session: TrainingSession, *arguments: Any, **values: Any) -> ShownPage:
        return ShownPage(self, session, arguments, values)


class ShownPage(SessionPage):
    """A page of a kind; its functions may change its `values`."""

    def __init__(
        self,
        kind: PageKind,
        session: TrainingSession,
        arguments: tuple[Any, ...],
        values: dict[str, Any],
    ) -> None:
        super().__init__(session)
        self.name, self.pause_goes_back = kind.name, kind.pause_goes_back
        self._kind, self._arguments, self._values = kind, arguments, values

    def set_value(self, name: str, value: Any) -> None:
        self._values[name] = value

    def content(self) -> PageContent:
        return self._kind.show(self, *self._arguments, **self._values)

    def back(self) -> None:
        self._kind.leave(self, *self._arguments, **self._values)

    def advance(self, dt: float) -> None:
        self._kind.advance(self, dt, *self._arguments, **self._values)

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        return self._kind.take_input(self, device, name, *self._arguments, **self._values)


def page_kind(name: str, **others: Any) -> Callable[[Callable[..., PageContent]], PageKind]:
    return lambda show: PageKind(name, show, **others)


def clickable_hint(session: TrainingSession, control: ControlName, key: str) -> Hint:
    return Hint(session.operator.label(control), session.texts.say(key), PRESS + control.value)
