"""The group Methods of registration of Scenario: the same simulated trials by every method."""

from __future__ import annotations

from typing import Any

import slicer

from rastrainer.errors import InputError
from rastrainer.number_text import fixed
from rastrainer.panels.cancelable_work import CancelableWork
from rastrainer.panels.training_panel import METHODS
from rastrainer.panels.widgets import chosenData, fillTable, setSentence
from rastrainer.protocol import RegistrationMethod
from rastrainer.slicer.logic.method_comparison_logic import ComparedMethod
from rastrainer.slicer.logic.module_session import ModuleSession
from rastrainer.slicer.translation import _

NAMES = {
    **METHODS,
    RegistrationMethod.BONE_SCREWS.value: _("Bone screws"),
    RegistrationMethod.SCAN.value: _("Range camera"),
}


class MethodsPanel:
    """Wires the group's widgets to the session."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        self._ui = ui
        self._session = session
        self._work = CancelableWork(self._showMessage, self._showProgress, self._showUsable)
        self._work.connectButton(ui.compareMethodsButton, self.compare)
        self._showMessage("")

    def close(self) -> None:
        """Cancel what is under way."""
        self._work.cancel()

    def compare(self) -> None:
        """Simulate trials on the chosen head, and show how each method registers them."""
        ui, logic = self._ui, self._session.methodComparison
        with slicer.util.tryWithErrorDisplay(_("The methods were not compared.")):
            name = chosenData(ui.scenarioComboBox)
            if not name:
                raise InputError(_("Choose a scenario that can be used."))
            scenario = self._session.scenario.find(name)
            trials, shift = ui.methodTrialsSpinBox.value, ui.methodShiftSpinBox.value
            self._showMessage(_("Trials are being simulated and registered."))
            found = self._work.run(lambda report: logic.compare(scenario, trials, shift, report))
            if found is not None:
                fillTable(ui.methodsTable, [_row(method) for method in found])
                self._showMessage(self._said(found))

    def _said(self, found: tuple[ComparedMethod, ...]) -> str:
        text = _(
            "Residuals of different methods are of different points: they do not show which is "
            "better. The true error does."
        )
        if len(found) == len(NAMES):
            return text
        few = _("The head has too few landmarks for the other methods.")
        return f"{text} {few}"

    def _showUsable(self) -> None:
        isAtWork = self._work.isUnderWay
        self._ui.compareMethodsButton.text = _("Cancel") if isAtWork else _("Compare")

    def _showProgress(self, step: str, _share: float) -> None:
        if step:
            self._showMessage(step)

    def _showMessage(self, sentence: str) -> None:
        setSentence(self._ui.methodsText, sentence)


def _row(method: ComparedMethod) -> tuple[str, ...]:
    low, high = method.interval
    return (
        NAMES.get(method.name, method.name),
        fixed(method.residual, 2),
        fixed(method.true, 2),
        fixed(method.expected, 2),
        _("{low} to {high}").format(low=fixed(low, 2), high=fixed(high, 2)),
        _("{share} %").format(share=fixed(100.0 * method.held, 0)),
    )
