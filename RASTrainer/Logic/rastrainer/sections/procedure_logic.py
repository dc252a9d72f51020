"""A trial's procedure from Slicer: its touches registered, its steps commanded, its lines shown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rastrainer.commands import CommandName
from rastrainer.procedure.errors import TrueLine
from rastrainer.protocol import PROCEDURE_PHASES, Phase
from rastrainer.scenario.scenario import Scenario
from rastrainer.sections.training_logic import knownNumber
from rastrainer.sections.trial_services import Question, Steps, TrialServices
from rastrainer.slicer.scene.procedure_lines import showPlannedLines, showProcedureErrors
from rastrainer.slicer.signal import Listening, Signal
from rastrainer.slicer.translation import _
from rastrainer.study.delivered_trial import REGISTER_OPEN
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.trial.touch_registration import GivenPoints, TouchRegistration


@dataclass(frozen=True)
class ProcedureStatus:
    """State of the procedure of the simulator's trial, everything by the registration in use.

    Attributes:
        name: of the procedure; empty where the trial has none.
        trajectory: number of the current line, from 0.
        entryDistanceMm: of the planned entry from the guide's axis; None without a guide.
        angleDeg: between guide and planned line; None without a guide.
        standOffMm: of the guide's tip from the entry; None without a guide.
        feedMm: how far drill or instrument is beyond the guide's tip.
        lastCheckMm: error at the checkpoint that was touched last; None before.
    """

    name: str = ""
    phase: str = Phase.IDLE.value
    trajectory: int = 0
    trajectories: int = 0
    isRegistered: bool = False
    entryDistanceMm: float | None = None
    angleDeg: float | None = None
    standOffMm: float | None = None
    feedMm: float = 0.0
    lastCheckMm: float | None = None

    @classmethod
    def of(cls, state: Mapping[str, Any]) -> ProcedureStatus:
        """Return the procedure's part of the simulator's state, which may hold anything."""
        phase, procedure = str(state.get("phase", Phase.IDLE.value)), state.get("procedure")
        if not isinstance(procedure, Mapping):
            return cls(phase=phase)
        lengths = ("entryDistanceMm", "angleDeg", "standOffMm", "lastCheckMm")
        return cls(
            name=str(procedure.get("name", "")),
            phase=phase,
            trajectory=int(knownNumber(procedure.get("trajectory")) or 0),
            trajectories=int(knownNumber(procedure.get("trajectories")) or 0),
            isRegistered=procedure.get("registrationInUse") is True,
            feedMm=knownNumber(procedure.get("feedMm")) or 0.0,
            **{name: knownNumber(procedure.get(name)) for name in lengths},
        )

    @property
    def isUnderWay(self) -> bool:
        return bool(self.name) and self.phase in PROCEDURE_PHASES


class ProcedureLogic(Listening):
    """What the Procedure panel does; answers come by a later `process` of the link.

    The touches of an open trial with a procedure are registered here, without being asked: the
    simulator waits for that as long as Slicer is connected. Nothing is revealed by it.

    Attributes:
        answered: emits the error of each command, empty if it was accepted.
        outcome: of the procedure that was scored last; None before, and during the next one.
        isRegistrationFailed: whether the touches that wait for it could not be registered; the
            reason has been emitted by `answered`.
    """

    def __init__(self, services: TrialServices) -> None:
        self.changed = Signal()
        self.outcomeChanged = Signal()
        self.answered = Signal()
        self.status = ProcedureStatus()
        self.outcome: ProcedureOutcome | None = None
        self.lines: tuple[TrueLine, ...] = ()
        self.isRegistrationFailed = False
        self._services = services
        self._trialId = ""
        self._registering = ""
        super().__init__(
            (services.link.stateChanged, self._follow), (services.link.opened, self._beginAgain)
        )

    def command(self, name: str, arguments: Mapping[str, Any] | None = None) -> None:
        self._services.link.send(name, arguments, lambda reply: self.answered.emit(reply.error))

    def showOutcome(self, outcome: ProcedureOutcome | None, lines: Sequence[TrueLine] = ()) -> None:
        """Show lines and errors of a procedure in place of others; None for those of no trial."""
        self.outcome, self.lines = outcome, tuple(lines)
        if outcome is None:
            showPlannedLines(self._services.scene, None)
        else:
            showProcedureErrors(self._services.scene, outcome.analysis, self.lines)
        self.outcomeChanged.emit()

    def showPlan(self, scenario: Scenario) -> None:
        named = [each for each in scenario.procedures if each.name == self.status.name]
        showPlannedLines(self._services.scene, named[0] if named else None)

    def _follow(self, state: Mapping[str, Any]) -> None:
        before, trialId = self.status, str(state.get("trialId", ""))
        self.status = status = ProcedureStatus.of(state)
        if trialId != self._trialId:
            self._trialId = trialId
            if status.name and self.outcome is not None:
                self.outcome = None
                self.outcomeChanged.emit()
        isWaiting = status.phase == Phase.VERIFYING.value and not status.isRegistered
        self.isRegistrationFailed = self.isRegistrationFailed and isWaiting
        if status != before:
            self.changed.emit()
        if not isWaiting:
            self._registering = ""
        elif status.name and self._registering != trialId:
            self._registering = trialId
            self._services.converse(self._registeringTouches(trialId))

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
