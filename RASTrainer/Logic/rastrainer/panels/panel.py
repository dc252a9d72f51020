"""What all sections have in common: their widgets, their clicks, and how they end."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rastrainer.panels.shown_errors import guardedAction
from rastrainer.panels.widgets import CancelableWork
from rastrainer.slicer.logic.module_session import ModuleSession
from rastrainer.slicer.signal import Listening, Signal
from rastrainer.work_progress import Progress


class Panel:
    """Wires the widgets of a section to the session, until it is closed."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        self._ui = ui
        self._session = session
        self._listening = Listening()
        self._works: list[CancelableWork] = []

    def close(self) -> None:
        """Cancel running work, and stop listening to the session."""
        for work in self._works:
            work.cancel()
        self._listening.close()

    def listen(self, *pairs: tuple[Signal, Callable[..., Any]]) -> None:
        self._listening = Listening(*pairs)

    def cancelableWork(
        self,
        showSentence: Callable[[str], None],
        show: Progress | None,
        showUsable: Callable[[], None],
    ) -> CancelableWork:
        """Return what runs work until this panel is closed."""
        self._works.append(CancelableWork(showSentence, show, showUsable))
        return self._works[-1]


def connectClick(button: Any, action: Callable[[], object], failure: str) -> None:
    """Have a click do something; where that fails, `failure` says what was not done."""
    button.connect("clicked()", guardedAction(action, failure))
