"""What all sections have in common: their widgets, their clicks, and how they end."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from rastrainer.errors import InputError
from rastrainer.scenario.scenario import Scenario
from rastrainer.sections.module_session import ModuleSession
from rastrainer.slicer.signal import Listening, Signal
from rastrainer.slicer.translation import _
from rastrainer.widgets.controls import CancelableWork, chosenData, setSilently
from rastrainer.widgets.shown_errors import guardedAction


class Panel(Listening):
    """Wires the widgets of a section to the session, until it is closed."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__()
        self._ui = ui
        self._session = session

    def close(self) -> None:
        """Cancel running work, and stop listening to the session."""
        for work in vars(self).values():
            if isinstance(work, CancelableWork):
                work.cancel()
        super().close()

    def showWhileOpen(self, section: Any, show: Callable[[], None], *signals: Signal) -> None:
        """Call `show` when a section is opened, and at signals while it is open."""

        def showIfOpen(*_values: Any) -> None:
            if not section.collapsed:
                show()

        section.connect("contentsCollapsed(bool)", showIfOpen)
        self.listen(*((signal, showIfOpen) for signal in signals))

    def saveCopy(self, work: CancelableWork, title: str, plan: list[str]) -> Scenario | None:
        """Copy the chosen scenario with a plan, as of `ScenarioFiles.saveWith`; use the copy."""
        scenario, files = chosenScenario(self._ui, self._session), self._session.scenarioFiles
        saved = work.run(partial(files.saveWith, plan, scenario.name, title.strip()))
        if saved is not None:
            self._session.scenarioMade.emit(saved.name)
        return saved

    def borrowLayout(
        self, button: Any, section: Any, purpose: str, show: Callable[[], None], failure: str
    ) -> None:
        """Have a checkable button `show` something in a borrowed layout, until it is unchecked.

        The user's layout returns when the section is folded, too.
        """
        layout = self._session.layout

        def change() -> None:
            show() if button.checked else layout.giveBack(purpose)

        def fold(isFolded: bool) -> None:
            if isFolded:
                layout.giveBack(purpose)

        def follow() -> None:
            setSilently(button, "checked", layout.purpose == purpose)

        connectClick(button, change, failure)
        section.connect("contentsCollapsed(bool)", fold)
        self.listen((self._session.sceneChanged, follow))


def connectClick(button: Any, action: Callable[[], object], failure: str) -> Callable[[], None]:
    """Connect a click to an action, which is returned; `failure` is shown if it fails."""
    guarded = guardedAction(action, failure)
    button.connect("clicked()", guarded)
    return guarded


def chosenScenario(ui: Any, session: ModuleSession) -> Scenario:
    """Return the scenario that is chosen in the section Scenario."""
    name = chosenData(ui.scenarioComboBox)
    if not name:
        raise InputError(_("Choose a scenario that can be used."))
    return session.scenarios.find(name)
