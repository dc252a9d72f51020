"""What all sections have in common: their widgets, their clicks, and how they end."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rastrainer.panels.shown_errors import guardedAction
from rastrainer.panels.widgets import CancelableWork
from rastrainer.slicer.logic.module_session import ModuleSession
from rastrainer.slicer.signal import Listening, Signal


class Panel:
    """Wires the widgets of a section to the session, until it is closed."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        self._ui = ui
        self._session = session
        self._listening = Listening()

    def close(self) -> None:
        """Cancel running work, and stop listening to the session."""
        for work in vars(self).values():
            if isinstance(work, CancelableWork):
                work.cancel()
        self._listening.close()

    def listen(self, *pairs: tuple[Signal, Callable[..., Any]]) -> None:
        self._listening = Listening(*pairs)


def connectClick(button: Any, action: Callable[[], object], failure: str) -> None:
    """Have a click do something; where that fails, `failure` says what was not done."""
    button.connect("clicked()", guardedAction(action, failure))
