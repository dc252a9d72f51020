"""A trial's procedure from Slicer: its touches registered, its steps commanded, its lines shown."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rastrainer.commands import CommandName
from rastrainer.igtl.client import Reply
from rastrainer.procedure.errors import TrueLine, true_lines
from rastrainer.protocol import PROCEDURE_PHASES, Phase
from rastrainer.scenario.scenario import Scenario
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.logic.training_logic import knownNumber
from rastrainer.slicer.program.child_process import Run, runHere
from rastrainer.slicer.scene.procedure_lines import showPlannedLines, showProcedureErrors
from rastrainer.slicer.signal import Listening, Signal
from rastrainer.slicer.translation import _
from rastrainer.study.delivered_trial import REGISTER_OPEN
from rastrainer.trial.analysis import TrialAnalysis
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.trial.touch_registration import GivenPoints, TouchRegistration

FEED_MM, FEED_MM_S = 1.0, 2.0
"""How far one press of a button feeds drill or instrument, and how fast."""


@dataclass(frozen=True)
class ProcedureStatus:
    """State of the procedure of the simulator's trial, everything by the registration in use.

    Attributes:
        name: of the procedure; empty where the trial has none.
        phase: of the trial.
        trajectory: number of the current line, from 0.
        trajectories: how many there are.
        isRegistered: whether a registration is in use.
        entryDistanceMm: of the planned entry from the guide's axis; None where there is no guide.
        angleDeg: between guide and planned line; None where there is no guide.
        standOffMm: of the guide's tip from the entry; None where there is no guide.
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
        procedure = state.get("procedure")
        if not isinstance(procedure, Mapping):
            return cls(phase=str(state.get("phase", Phase.IDLE.value)))
        return cls(
            name=str(procedure.get("name", "")),
            phase=str(state.get("phase", Phase.IDLE.value)),
            trajectory=int(knownNumber(procedure.get("trajectory")) or 0),
            trajectories=int(knownNumber(procedure.get("trajectories")) or 0),
            isRegistered=procedure.get("registrationInUse") is True,
            entryDistanceMm=knownNumber(procedure.get("entryDistanceMm")),
            angleDeg=knownNumber(procedure.get("angleDeg")),
            standOffMm=knownNumber(procedure.get("standOffMm")),
            feedMm=knownNumber(procedure.get("feedMm")) or 0.0,
            lastCheckMm=knownNumber(procedure.get("lastCheckMm")),
        )

    @property
    def isUnderWay(self) -> bool:
        """Whether the touches are done, and the procedure continues."""
        return bool(self.name) and self.phase in PROCEDURE_PHASES


class ProcedureLogic:
    """What the Procedure panel does; answers come by a later `process` of the link.

    The touches of an open trial with a procedure are registered here, without being asked: the
    simulator waits for that as long as Slicer is connected. Nothing is revealed by it.

    Attributes:
        changed: emits nothing, whenever `status` or `outcome` has changed.
        answered: emits the sentence of a command that was refused, empty where it was accepted.
        status: of the trial's procedure.
        outcome: of the procedure that was scored last; None before, and during the next one.
        isRegistrationFailed: whether the touches that wait for it could not be registered; the
            reason has been emitted by `answered`.
    """

    def __init__(
        self,
        scene: Any,
        link: Link,
        findScenario: Callable[[str], Scenario],
        work: BackgroundWork,
        run: Run = runHere,
    ) -> None:
        """Follow the trials of a link.

        Args:
            findScenario: gives the scenario of a name, in any thread.
            work: in which touches are registered.
            run: runs the function that does so.
        """
        self.changed = Signal()
        self.answered = Signal()
        self.status = ProcedureStatus()
        self.outcome: ProcedureOutcome | None = None
        self.lines: tuple[TrueLine, ...] = ()
        self.isRegistrationFailed = False
        self._scene = scene
        self._link = link
        self._findScenario = findScenario
        self._work = work
        self._run = run
        self._trialId = ""
        self._registering = ""
        self._listening = Listening(
            (link.stateChanged, self._follow), (link.opened, self._beginAgain)
        )

    def close(self) -> None:
        """Stop listening to the link."""
        self._listening.close()

    def command(self, name: str, arguments: Mapping[str, Any] | None = None) -> None:
        self._link.send(name, arguments, lambda reply: self.answered.emit(reply.error))

    def feed(self, forward: bool) -> None:
        """Move drill or instrument by a millimeter along the guide."""
        velocity = FEED_MM_S if forward else -FEED_MM_S
        arguments = {"velocityMmS": velocity, "durationS": FEED_MM / FEED_MM_S}
        self.command(CommandName.FEED, arguments)

    def takeScored(self, analysis: TrialAnalysis, isOtherOpen: bool) -> None:
        """Take the errors of a scored trial, and show them unless another trial is played."""
        record, truth = analysis.record.procedure, analysis.truth
        if record is not None and truth is not None and not isOtherOpen:
            self.showOutcome(analysis.procedure, true_lines(record, truth.matrix))

    def showOutcome(self, outcome: ProcedureOutcome | None, lines: Sequence[TrueLine] = ()) -> None:
        """Show lines and errors of a procedure in place of others; None for those of no trial."""
        self.outcome, self.lines = outcome, tuple(lines)
        if outcome is None:
            showPlannedLines(self._scene, None)
        else:
            showProcedureErrors(self._scene, outcome.analysis, self.lines)
        self.changed.emit()

    def showPlan(self, scenario: Scenario) -> None:
        named = [each for each in scenario.procedures if each.name == self.status.name]
        showPlannedLines(self._scene, named[0] if named else None)

    def _follow(self, state: Mapping[str, Any]) -> None:
        status, trialId = ProcedureStatus.of(state), str(state.get("trialId", ""))
        shown = self.status, self.outcome
        if trialId != self._trialId:
            self._trialId = trialId
            self.outcome = None if status.name else self.outcome
        isWaiting = status.phase == Phase.VERIFYING.value and not status.isRegistered
        self.isRegistrationFailed = self.isRegistrationFailed and isWaiting
        self.status = status
        if shown != (self.status, self.outcome):
            self.changed.emit()
        if not isWaiting:
            self._registering = ""
        elif status.name and self._registering != trialId:
            self._registering = trialId
            self._register(trialId)

    def _beginAgain(self) -> None:
        self._registering = ""

    def _register(self, trialId: str) -> None:
        """Have the touches of the open trial registered, and the procedure continue with that."""

        def ask(name: str, arguments: Mapping[str, Any], take: Callable[[Reply], None]) -> None:
            self._link.send(
                name, arguments, lambda reply: take(reply) if reply.ok else fail(reply.error)
            )

        def askForTouches(reply: Reply) -> None:
            scenario = str(reply.data.get("scenario", ""))
            ask(
                CommandName.GET_TRIAL,
                {"trialId": trialId},
                lambda reply: self._work.do(
                    lambda: self._registered(reply.data, scenario), use, fail
                ),
            )

        def use(registered: TouchRegistration) -> None:
            ask(CommandName.USE_REGISTRATION, registered.arguments(trialId), lambda _reply: None)

        def fail(reason: Exception | str) -> None:
            # The procedure may have continued meanwhile, with another client's registration.
            if self._registering == trialId:
                self.isRegistrationFailed = True
                text = _("The touches were not registered: {reason}")
                self.answered.emit(text.format(reason=reason))
                self.changed.emit()

        ask(CommandName.LIST_TASKS, {}, askForTouches)

    def _registered(self, answer: Mapping[str, Any], scenarioName: str) -> TouchRegistration:
        scenario = self._findScenario(scenarioName)
        progress = self._work.checkWanted
        return self._run(REGISTER_OPEN, progress, GivenPoints.of_answer(answer), scenario)
