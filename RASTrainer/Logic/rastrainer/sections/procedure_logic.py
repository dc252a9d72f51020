"""A trial's procedure from Slicer: its touches registered, its steps commanded, its lines shown."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rastrainer.commands import CommandName
from rastrainer.procedure.errors import TrueLine, true_lines
from rastrainer.procedure.record import ProcedureRecord
from rastrainer.protocol import Phase
from rastrainer.scenario.scenario import Scenario
from rastrainer.sections.training_logic import TrialStatus, readStatus
from rastrainer.sections.trial_services import Question, Steps, TrialServices
from rastrainer.slicer.scene.procedure_lines import showPlannedLines, showProcedureErrors
from rastrainer.slicer.signal import Listening, Signal
from rastrainer.slicer.translation import _
from rastrainer.study.delivered_trial import REGISTER_OPEN
from rastrainer.trial.analysis import RevealedTruth
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.trial.touch_registration import GivenPoints, TouchRegistration


class ProcedureLogic(Listening):
    """Work of the section Procedure; answers come by a later `process` of the link.

    The touches of an open trial with a procedure are registered here, without being asked: the
    simulator waits for that as long as Slicer is connected. Nothing is revealed by it.

    Attributes:
        answered: emits the error of each command, empty if it was accepted.
        outcome: of the procedure that was scored last; None before, and during the next one.
        isRegistrationFailed: whether the touches that wait for it could not be registered; the
            reason has been emitted by `answered`.
    """

    def __init__(self, services: TrialServices) -> None:
        self.changed, self.outcomeChanged, self.answered = Signal(), Signal(), Signal()
        self.status = TrialStatus()
        self.outcome: ProcedureOutcome | None = None
        self.lines: list[TrueLine] = []
        self.isRegistrationFailed = False
        self._services = services
        self._registering = ""
        super().__init__(
            (services.link.stateChanged, self._follow), (services.link.opened, self._beginAgain)
        )

    def command(self, name: str, arguments: Mapping[str, Any] | None = None) -> None:
        self._services.link.send(name, arguments, lambda reply: self.answered.emit(reply.error))

    def showOutcome(
        self,
        outcome: ProcedureOutcome | None,
        record: ProcedureRecord | None = None,
        truth: RevealedTruth | None = None,
    ) -> None:
        """Show lines and errors of a trial's procedure in place of others; nothing without one."""
        self.outcome, self.lines = outcome, []
        if outcome is None or record is None or truth is None:
            showPlannedLines(self._services.scene, None)
        else:
            self.lines = true_lines(record, truth.matrix)
            showProcedureErrors(self._services.scene, outcome.analysis, self.lines)
        self.outcomeChanged.emit()

    def showPlan(self, scenario: Scenario) -> None:
        wanted = self.status.procedure.name
        named = [each for each in scenario.procedures if each.name == wanted]
        showPlannedLines(self._services.scene, named[0] if named else None)

    def _follow(self, state: Mapping[str, Any]) -> None:
        before, self.status = self.status, readStatus(state)
        status, procedure = self.status, self.status.procedure
        if status.trialId != before.trialId and procedure.name and self.outcome is not None:
            self.outcome = None
            self.outcomeChanged.emit()
        isWaiting = status.phase == Phase.VERIFYING.value and not procedure.registrationInUse
        self.isRegistrationFailed = self.isRegistrationFailed and isWaiting
        if (status.phase, procedure) != (before.phase, before.procedure):
            self.changed.emit()
        if not isWaiting:
            self._registering = ""
        elif procedure.name and self._registering != status.trialId:
            self._registering = status.trialId
            self._services.converse(self._registeringTouches(status.trialId))

    def _beginAgain(self) -> None:
        self._registering = ""

    def _registeringTouches(self, trialId: str) -> Steps:
        """Have the touches of the open trial registered, and the procedure continue with that."""
        try:
            tasks = yield Question(CommandName.LIST_TASKS, {})
            answer = yield Question(CommandName.GET_TRIAL, {"trialId": trialId})

            def register() -> TouchRegistration:
                scenario = self._services.findScenario(str(tasks.get("scenario", "")))
                given = GivenPoints.of_answer(answer)
                return self._services.runWanted(REGISTER_OPEN, given, scenario)

            registered = yield register
            yield Question(CommandName.USE_REGISTRATION, registered.arguments(trialId))
        except Exception as error:
            # The procedure may have continued meanwhile, with another client's registration.
            if self._registering == trialId:
                self.isRegistrationFailed = True
                text = _("The touches were not registered: {reason}").format(reason=error)
                self.answered.emit(text)
                self.changed.emit()
