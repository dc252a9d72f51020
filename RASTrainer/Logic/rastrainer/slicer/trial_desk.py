"""What happens when a finished trial arrives: registered, kept, acknowledged, scored, one by one.

Checking, registering, scoring and storing is done in the background; the scene and the link are the
main thread's.

Nothing is lost and nothing counts twice, whatever is cut on the way. The simulator offers a trial
until it is acknowledged, and it is acknowledged only when it is in the study; what is in the study
without its truth is scored again over the next connection.
"""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from rastrainer.ctps import Trial
from rastrainer.protocol import OPEN_PHASES, CommandName
from rastrainer.revealed_truth import RevealedTruth
from rastrainer.scenario import Scenario
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link import Link
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _
from rastrainer.slicer.trial_scene import showTrial
from rastrainer.slicer.trial_scoring import TrialScoring
from rastrainer.study import DeletedTrialError, Study
from rastrainer.trial_analysis import TrialAnalysis
from rastrainer.trial_intake import Intake, take_in
from rastrainer.trial_record import TrialRecord
from rastrainer.trial_review import review

MOST_WAITING = 32
"""Trials that wait to be scored; a simulator that has more offers them again."""


class TrialDesk:
    """Takes in the trials that a link hands over.

    Attributes:
        trialKept: emits each `TrialRecord` that comes in, once it is in the study.
        trialScored: emits each `TrialAnalysis` with truth and score, once they are in the study.
        problemFound: emits a sentence about a trial that could not be kept or scored.
        received: UUIDs of the trials that came in and are safe, in their order.
    """

    def __init__(
        self,
        scene: Any,
        link: Link,
        findScenario: Callable[[str], Scenario],
        openStudy: Callable[[], Study],
        work: BackgroundWork,
        cohort: Sequence[Trial] = (),
        records: Path | None = None,
    ) -> None:
        """Take in the trials of a link.

        Args:
            scene: the scene.
            link: to the simulator.
            findScenario: gives the scenario of a name, in any thread.
            openStudy: opens the study, in any thread; it may wait for a lock there.
            work: in which trials are scored and kept.
            cohort: what CTPS compares with.
            records: folder of the simulator's journals, if it is on this computer.
        """
        self.trialKept = Signal()
        self.trialScored = Signal()
        self.problemFound = Signal()
        self.received: list[str] = []
        self._scene = scene
        self._link = link
        self._findScenario = findScenario
        self._openStudy = openStudy
        self._work = work
        self._cohort = cohort
        self._records = records
        self._deliveries: deque[Mapping[str, Any]] = deque()
        self._scoring = TrialScoring(link, work, openStudy, self._analyze)
        self._isTaking = False
        self._told: set[str] = set()
        self._revealed: set[str] = set()
        self._untold: deque[TrialRecord] = deque()
        self._state: Mapping[str, Any] = {}
        self._lastProblem = ""
        link.trialCompleted.connect(self._receive)
        link.stateChanged.connect(self._followTraining)
        link.opened.connect(self._resume)

    def close(self) -> None:
        """Listen to the link no more, and begin nothing more."""
        self._link.trialCompleted.disconnect(self._receive)
        self._link.stateChanged.disconnect(self._followTraining)
        self._link.opened.disconnect(self._resume)
        self.forgetWaiting()

    def forgetWaiting(self) -> None:
        """Leave undone what has not begun: the simulator offers it again, for another study."""
        self._deliveries.clear()
        self._untold.clear()
        self._revealed.clear()

    def _followTraining(self, state: Mapping[str, Any]) -> None:
        self._state = state

    def _receive(self, value: Mapping[str, Any]) -> None:
        """Let a delivered trial wait for its turn; what is left out is offered again."""
        trialId = value.get("trialId")
        if any(waiting.get("trialId") == trialId for waiting in self._deliveries):
            return
        if len(self._deliveries) >= MOST_WAITING:
            self._complain(
                _("Trials arrive faster than they can be scored; they are offered again later.")
            )
            return
        self._deliveries.append(value)
        self._takeNext()

    def _takeNext(self) -> None:
        """Check, score and keep one trial in the background; the next follows."""
        if self._isTaking or not self._deliveries:
            return
        self._isTaking = True
        value = self._deliveries[0]
        isBeingTold = value.get("trialId") in self._told
        self._work.do(
            lambda: self._takeIn(value, isBeingTold),
            lambda intake: self._finish(value, lambda: self._accept(intake)),
            lambda error: self._finish(value, lambda: self._refuse(value, error)),
        )

    def _takeIn(self, value: Mapping[str, Any], isBeingTold: bool) -> Intake:
        with self._openStudy() as study:
            return take_in(value, study, lambda record: self._analyze(record, study), isBeingTold)

    def _finish(self, value: Mapping[str, Any], go: Callable[[], None]) -> None:
        self._isTaking = False
        if self._deliveries and self._deliveries[0] is value:
            self._deliveries.popleft()
        try:
            go()
        finally:
            self._takeNext()

    def _accept(self, intake: Intake) -> None:
        """Acknowledge a trial that is kept, then go on with it."""
        record = intake.record
        self._acknowledge(record.trial_id)
        if intake.problem:
            self._complain(
                _("A trial is kept but cannot be scored: {error}").format(error=intake.problem)
            )
        if record.trial_id not in self.received:
            self.received.append(record.trial_id)
            self.trialKept.emit(record)
        if intake.analysis is not None and record.trial_id not in self._told:
            self._score(intake.analysis, self._complain)
            self._work.later(lambda: self._show(intake.analysis))

    def _refuse(self, value: Mapping[str, Any], error: Exception) -> None:
        if isinstance(error, DeletedTrialError):
            # Its trainee is gone for good: it must not be offered for ever.
            self._acknowledge(value["trialId"])
        else:
            self._complain(_("A trial could not be kept: {error}").format(error=error))

    def _acknowledge(self, trialId: str) -> None:
        self._link.send(CommandName.ACKNOWLEDGE_TRIAL, {"trialId": trialId})

    def _analyze(
        self, record: TrialRecord, study: Study, truth: RevealedTruth | None = None
    ) -> TrialAnalysis:
        scenario = self._findScenario(record.scenario)
        # To register it nothing is needed of its journal, which takes long to read.
        records = None if truth is None else self._records
        return review(record, scenario, study, records, self._cohort, truth)

    def _resume(self) -> None:
        """Go on with trials whose score was told to nobody before the connection was cut."""

        def take(records: tuple[TrialRecord, ...]) -> None:
            self._untold = deque(records)
            self._resumeNext()

        def unrevealed() -> tuple[TrialRecord, ...]:
            with self._openStudy() as study:
                return study.unrevealed()

        self._work.do(unrevealed, take, lambda error: self._complain(str(error)))

    def _resumeNext(self) -> None:
        """Score and tell one trial; the next follows its answer.

        If all were scored at once, a trial that arrives meanwhile would wait for all of them.
        """
        while self._untold and self._link.isOpen:
            record = self._untold.popleft()
            # Since the list was read it may have been told, or be about to be.
            if record.trial_id not in self._told | self._revealed:
                self._told.add(record.trial_id)
                self._work.do(
                    lambda record=record: self._analyzeAgain(record),
                    # A trial of another simulator is none of this one's business.
                    lambda analysis: self._score(analysis, logging.info, self._resumeNext),
                    lambda error, record=record: self._resumeAfter(record, error),
                )
                return

    def _analyzeAgain(self, record: TrialRecord) -> TrialAnalysis:
        with self._openStudy() as study:
            return self._analyze(record, study)

    def _resumeAfter(self, record: TrialRecord, error: Exception) -> None:
        self._told.discard(record.trial_id)
        self._complain(_("A trial is kept but cannot be scored: {error}").format(error=error))
        self._resumeNext()

    def _show(self, analysis: TrialAnalysis) -> None:
        """Show a trial in the scene, unless another one is being played there."""
        isOther = self._state.get("trialId") != analysis.record.trial_id
        if isOther and self._state.get("phase") in OPEN_PHASES:
            return
        showTrial(self._scene, self._findScenario(analysis.record.scenario), analysis)

    def _score(
        self,
        analysis: TrialAnalysis,
        complain: Callable[[str], None],
        goOn: Callable[[], None] = lambda: None,
    ) -> None:
        trialId = analysis.record.trial_id
        self._told.add(trialId)

        def end(error: Exception | None = None) -> None:
            self._told.discard(trialId)
            if error is not None:
                complain(_("The trial was not scored: {error}").format(error=error))
            goOn()

        def take(scored: TrialAnalysis) -> None:
            self._revealed.add(trialId)
            try:
                self.trialScored.emit(scored)
            finally:
                end()

        self._scoring.begin(analysis, take, end)

    def _complain(self, sentence: str) -> None:
        """Tell a problem once, though the trial is offered every two seconds."""
        if sentence != self._lastProblem:
            self._lastProblem = sentence
            self.problemFound.emit(sentence)
