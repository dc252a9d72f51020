"""What happens when a finished trial arrives: registered, stored, acknowledged and scored.

Checking, registering, scoring and storing is done in the background; the scene and the link are the
main thread's.

Nothing is lost and nothing counts twice, whatever is cut on the way. The simulator offers a trial
until it is acknowledged, and it is acknowledged only when it is in the study; what is in the study
without its truth is scored again over the next connection, and after the study was away.

A trial is scored in an order that rules out cheating: the registration is submitted, which makes it
final; the simulator reveals the truth; the score is computed, sent and stored. Where the study
asks for it, the trial and the truth must follow from the trial's journal, which is fetched first.
"""

from __future__ import annotations

import logging
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from rastrainer.commands import CommandName
from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.json_records import record_from_json
from rastrainer.protocol import OPEN_PHASES
from rastrainer.scenario.scenario import Scenario
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.logic.delivery_queue import Delivery, DeliveryQueue
from rastrainer.slicer.logic.journal_request import End, fetchJournal
from rastrainer.slicer.program.child_process import Run, runHere
from rastrainer.slicer.scene.trial_scene import showTrial
from rastrainer.slicer.signal import Listening, Signal
from rastrainer.slicer.translation import _
from rastrainer.study.database.database import StudyBusyError
from rastrainer.study.database.study import Study
from rastrainer.study.delivered_trial import (
    REGISTER,
    SCORE,
    DeliveredTrial,
    checks_journals,
    score_references,
    store_delivered,
    with_progress,
)
from rastrainer.trial.analysis import (
    RevealedTruth,
    TrialAnalysis,
    registration_arguments,
    score_arguments,
)
from rastrainer.trial.ctps import Trial
from rastrainer.trial.record import TrialRecord

RETRY_S = 5.0
"""After a study was locked or unreachable, until its trials are looked for again."""
ANSWER_TIMEOUT_S = 60.0
"""No user waits for these answers, and what times out is requested again only over the next
connection: a busy simulator gets the time it needs."""


class TrialLogic:
    """Receives the trials of a link.

    Attributes:
        trialKept: emits each received `TrialRecord` when it is in the study.
        trialScored: emits each `TrialAnalysis` with truth and score, when they are in the study.
        problemFound: emits a sentence about a trial that could not be stored or scored.
        received: UUIDs of the received trials that are in the study, in their order.
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
        run: Run = runHere,
    ) -> None:
        """Begin to listen.

        Args:
            findScenario: gives the scenario of a name, in any thread.
            openStudy: opens the study, in any thread; it may wait for a lock there.
            cohort: the trials that CTPS compares with.
            records: folder of the simulator's journals, if it is on this computer.
            run: runs the functions that register and score trials.
        """
        self.trialKept = Signal()
        self.trialScored = Signal()
        self.received: list[str] = []
        self._scene = scene
        self._link = link
        self._findScenario = findScenario
        self._openStudy = openStudy
        self._work = work
        self._cohort = cohort
        self._records = records
        self._run = run
        self._beingScored: set[str] = set()
        self._scored: set[str] = set()
        self._unscored: deque[TrialRecord] = deque()
        self._state: Mapping[str, Any] = {}
        self._retryAt: float | None = None
        # What this simulator has refused, such as trials of another one.
        self._refused: set[str] = set()
        self._queue: DeliveryQueue[DeliveredTrial] = DeliveryQueue(
            link,
            link.trialCompleted,
            work,
            self._storing,
            self._accept,
            _("A trial could not be stored: {error}"),
            _("Trials arrive faster than they can be scored; they will be offered again later."),
        )
        self.problemFound = self._queue.problemFound
        self._listening = Listening(
            (link.stateChanged, self._followTraining), (link.opened, self._resumeAll)
        )

    def close(self) -> None:
        """Stop listening to the link, and start nothing more."""
        self._queue.close()
        self._listening.close()
        self.forgetWaiting()

    def forgetWaiting(self) -> None:
        """Drop what has not started: the simulator offers it again, for another study."""
        self._queue.forgetWaiting()
        self._unscored.clear()
        self._refused.clear()
        self.received.clear()
        self._scored.clear()

    def isBeingScored(self, trialId: str) -> bool:
        return self._queue.isStoring(trialId) or trialId in self._beingScored

    def _followTraining(self, state: Mapping[str, Any]) -> None:
        self._state = state
        if self._retryAt is not None and time.monotonic() >= self._retryAt:
            self._resume()

    def _noteFailure(self, error: Exception, *trialIds: str) -> None:
        if isinstance(error, StudyBusyError):
            self._retryAt = time.monotonic() + RETRY_S
        else:
            self._refused.update(trialIds)

    def _resumeAll(self) -> None:
        self._refused.clear()
        self._resume()

    def _storing(self, delivery: Delivery) -> Callable[[], DeliveredTrial]:
        """Return what checks, registers and stores a trial, in the background."""
        isUnderWay = str(delivery.get("trialId", "")) in self._beingScored

        def store() -> DeliveredTrial:
            with self._openStudy() as study:
                return store_delivered(delivery, study, self._analyze, isUnderWay)

        return store

    def _accept(self, intake: DeliveredTrial) -> None:
        """Score a trial that is stored and acknowledged."""
        record, analysis = intake.record, intake.analysis
        if intake.problem:
            self._reportUnscored(intake.problem)
        if record.trial_id not in self.received:
            self.received.append(record.trial_id)
            self.trialKept.emit(record)
        if analysis is not None and record.trial_id not in self._beingScored:
            self._score(analysis, self._queue.report)
            self._work.later(lambda: self._show(analysis))

    def _analyze(self, record: TrialRecord) -> TrialAnalysis:
        scenario = self._findScenario(record.scenario)
        return self._run(REGISTER, self._work.checkWanted, record, scenario, self._cohort)

    def _resume(self) -> None:
        """Score the trials that were not scored before connection or study were lost."""
        self._retryAt = None

        def take(records: tuple[TrialRecord, ...]) -> None:
            self._unscored = deque(records)
            self._resumeNext()

        def unrevealed() -> tuple[TrialRecord, ...]:
            with self._openStudy() as study:
                return study.unrevealed()

        def refuse(error: Exception) -> None:
            self._noteFailure(error)
            self._queue.report(str(error))

        self._work.do(unrevealed, take, refuse)

    def _resumeNext(self) -> None:
        """Score one trial; the next follows when the simulator has answered.

        If all were scored at once, a trial that arrives meanwhile would wait for all of them.
        """
        while self._unscored and self._link.isOpen:
            record = self._unscored.popleft()
            # Since the list was read it may have been scored.
            if record.trial_id not in self._beingScored | self._scored | self._refused:
                self._scoreAgain(record)
                return

    def _scoreAgain(self, record: TrialRecord) -> None:
        self._beingScored.add(record.trial_id)

        def take(analysis: TrialAnalysis) -> None:
            # A trial of another simulator does not concern this one.
            self._score(analysis, logging.info, self._resumeNext)

        def refuse(error: Exception) -> None:
            self._beingScored.discard(record.trial_id)
            self._reportUnscored(error)
            self._resumeNext()

        self._work.do(lambda: self._analyze(record), take, refuse)

    def _reportUnscored(self, reason: object) -> None:
        self._queue.report(
            _("A trial is stored but cannot be scored: {error}").format(error=reason)
        )

    def _show(self, analysis: TrialAnalysis) -> None:
        """Show a trial in the scene, unless another one is being played there."""
        isOther = self._state.get("trialId") != analysis.record.trial_id
        if isOther and self._state.get("phase") in OPEN_PHASES:
            return
        scenario = self._findScenario(analysis.record.scenario)
        showTrial(self._scene, scenario, analysis, self._work.changeScene)

    def _score(
        self,
        analysis: TrialAnalysis,
        report: Callable[[str], None],
        proceed: Callable[[], None] = lambda: None,
    ) -> None:
        trialId = analysis.record.trial_id
        self._beingScored.add(trialId)

        def fail(error: Exception) -> None:
            self._beingScored.discard(trialId)
            self._scored.discard(trialId)
            self._noteFailure(error, trialId)
            report(_("The trial was not scored: {error}").format(error=error))
            proceed()

        def take(scored: TrialAnalysis) -> None:
            self._beingScored.discard(trialId)
            self._scored.add(trialId)
            try:
                self.trialScored.emit(scored)
            finally:
                proceed()

        self._reveal(analysis, take, fail)

    def _reveal(
        self, analysis: TrialAnalysis, take: Callable[[TrialAnalysis], None], end: End
    ) -> None:
        """Have a registered trial that is in the study revealed and scored.

        If that is interrupted, the truth is not stored, and all of it is done again over the next
        connection, with the same outcome. `take` receives the analysis with truth and score once
        they are in the study, `end` the reason for a failure.
        """

        def score(answer: Mapping[str, Any]) -> None:
            truth = record_from_json(RevealedTruth, answer, "The simulator's answer")
            self._work.do(
                self._checksJournals,
                lambda isChecked: fetch(truth) if isChecked else compute(truth, None),
                end,
            )

        def fetch(truth: RevealedTruth) -> None:
            trialId = analysis.record.trial_id
            fetchJournal(self._ask, trialId, lambda journal: compute(truth, journal), end)

        def compute(truth: RevealedTruth, journal: bytes | None) -> None:
            self._work.do(
                lambda: self._storeScore(analysis, truth, journal),
                lambda scored: report(scored, truth),
                lambda error: refuse(error, truth),
            )

        def refuse(error: Exception, truth: RevealedTruth) -> None:
            """Store the truth of a trial that can never be scored; others are requested again."""
            if isinstance(error, StudyBusyError):
                end(error)
                return
            keep(truth, lambda _none: end(error))

        def report(scored: TrialAnalysis, truth: RevealedTruth) -> None:
            self._ask(
                CommandName.TRIAL_SCORED,
                score_arguments(scored),
                lambda _answer: keep(truth, lambda _none: take(scored)),
                end,
            )

        def keep(truth: RevealedTruth, proceed: Callable[[None], None]) -> None:
            def store() -> None:
                with self._openStudy() as study:
                    trial = analysis.record.trial_id
                    study.set_truth(trial, truth.true_tre_mm, truth.head_to_world)

            self._work.do(store, proceed, end)

        self._ask(CommandName.SUBMIT_REGISTRATION, registration_arguments(analysis), score, end)

    def _ask(
        self,
        command: str,
        arguments: dict[str, Any],
        go: Callable[[Mapping[str, Any]], None],
        end: End,
    ) -> None:
        def takeAnswer(reply: Reply) -> None:
            try:
                if not reply.ok:
                    raise InputError(reply.error)
                go(reply.data)
            except InputError as error:
                end(error)

        self._link.send(command, arguments, takeAnswer, ANSWER_TIMEOUT_S)

    def _checksJournals(self) -> bool:
        with self._openStudy() as study:
            return checks_journals(study)

    def _storeScore(
        self, analysis: TrialAnalysis, truth: RevealedTruth, journal: bytes | None
    ) -> TrialAnalysis:
        record = analysis.record
        with self._openStudy() as study:
            scored = self._run(
                SCORE,
                self._work.checkWanted,
                analysis,
                truth,
                self._findScenario(record.scenario),
                score_references(study),
                self._records,
                journal,
            )
            study.add_results(record.trial_id, score=scored.score, procedure=scored.procedure)
            return with_progress(scored, study)
