"""Finished trials, when they arrive, are registered, stored, acknowledged and scored.

Checking, registering, scoring and storing is done in the background; the scene and the link are the
main thread's.

Nothing is lost and nothing counts twice, wherever a connection or program is cut. The simulator
offers a trial until it is acknowledged, and it is acknowledged only when it is in the study; a
trial in the study without its truth is scored again over the next connection, and after the study
was away.

A trial is scored in an order that rules out cheating: the registration is submitted, which makes it
final; the simulator reveals the truth; the score is computed, sent and stored. Where the study
asks for it, the trial and the truth must follow from the trial's journal, which is fetched first.
"""

from __future__ import annotations

import logging
import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

from rastrainer.commands import CommandName
from rastrainer.decision.drill_record import DrillRecord
from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json
from rastrainer.protocol import MAX_JOURNAL_BYTES
from rastrainer.sections.training_logic import TrialStatus, readStatus
from rastrainer.sections.trial_services import Question, Steps, TrialServices
from rastrainer.slicer.scene.trial_scene import showTrial
from rastrainer.slicer.signal import Listening, Signal
from rastrainer.slicer.translation import _
from rastrainer.study.database.database import StudyBusyError
from rastrainer.study.database.study import DeletedTrialError, Study
from rastrainer.study.delivered_trial import (
    REGISTER,
    SCORE,
    checks_journals,
    score_references,
    store_delivered,
    with_progress,
)
from rastrainer.trial.analysis import RevealedTruth, TrialAnalysis, score_arguments
from rastrainer.trial.record import AbortedTrial, TrialRecord
from rastrainer.trial.trial_row import TrialRow

Delivery = Mapping[str, Any]
"""The record of a trial as it was delivered, not yet checked."""

MAX_WAITING = 32
"""Most trials waiting to be stored; a simulator that has more offers them again."""
REFUSAL = _("A trial could not be stored: {error}")
ABORTED_REFUSAL = _("An aborted trial could not be stored: {error}")
TOO_MANY = _("Trials arrive faster than they can be scored; they will be offered again later.")
RETRY_S = 5.0
"""Pause before the next attempt after a study was locked or unreachable."""
ANSWER_TIMEOUT_S = 60.0
"""No user waits for these answers, and what times out is requested again only over the next
connection: a busy simulator gets the time it needs."""


class TrialLogic(Listening):
    """Receives the finished and the aborted trials of a link.

    Finished trials are stored in their order, each after the former is accepted. After a break in
    the connection, an aborted trial arrives before its repeat, and is stored before anything that
    arrives later: a repeat counts in a study only once a reason was given for it.

    Attributes:
        problemFound: emits a sentence about a trial that was not stored, or not scored.
        trialKept, abortedKept, drillKept: emit each received `TrialRecord`, `AbortedTrial` or
            `DrillRecord` when it is in the study; nothing is stored of a trial in which nothing was
            done.
        trialScored: emits each `TrialAnalysis` with truth and score, when they are in the study.
        received: UUIDs of the received trials that are in the study, in their order.
    """

    def __init__(self, services: TrialServices, cohort: Sequence[TrialRow] = ()) -> None:
        link = services.link
        super().__init__(
            (link.trialCompleted, self._receive),
            (link.trialAborted, self._receiveAborted),
            (link.stateChanged, self._followTraining),
            (link.opened, self._resumeAll),
        )
        self.problemFound, self.trialScored = Signal(), Signal()
        self.trialKept, self.abortedKept, self.drillKept = Signal(), Signal(), Signal()
        self.received: list[str] = []
        self._services, self._cohort = services, cohort
        self._waiting: deque[Delivery] = deque()
        self._underWay: list[Delivery] = []
        self._aborted: list[Delivery] = []
        self._lastProblems: dict[str, str] = {}
        self._unscored: deque[TrialRecord] = deque()
        self._beingScored, self._scored = set[str](), set[str]()
        # Trials that this simulator has refused, such as trials of another simulator.
        self._refused: set[str] = set()
        self._playing = TrialStatus()
        self._retryAt: float | None = None

    def close(self) -> None:
        super().close()
        self.forgetWaiting()

    def forgetWaiting(self) -> None:
        """Drop the waiting trials: the simulator offers them again, for another study."""
        for each in (self._waiting, self._lastProblems, self._unscored, self._refused):
            each.clear()
        self.received.clear()
        self._scored.clear()

    def report(self, sentence: str, kind: str = "") -> None:
        """Report a problem once, though the trial is offered every two seconds."""
        if sentence != self._lastProblems.get(kind):
            self._lastProblems[kind] = sentence
            self.problemFound.emit(sentence)

    def _receive(self, delivery: Delivery) -> None:
        """Queue a delivered trial; the simulator offers a dropped one again."""
        known = (*self._underWay, *self._waiting)
        if _isIn(known, delivery):
            return
        if len(known) >= MAX_WAITING:
            self.report(TOO_MANY)
            return
        self._waiting.append(delivery)
        self._storeNext()

    def _receiveAborted(self, delivery: Delivery) -> None:
        if len(self._aborted) < MAX_WAITING and not _isIn(self._aborted, delivery):
            steps = self._keeping(delivery, self._aborted, self._storeAborted)
            self._services.converse(steps)

    def _storeNext(self) -> None:
        if self._waiting and not self._underWay:
            delivery = self._waiting.popleft()
            self._services.converse(self._keeping(delivery, self._underWay, self._store))

    def _keeping(
        self, delivery: Delivery, underWay: list[Delivery], store: Callable[[Delivery], Any]
    ) -> Steps:
        """Store a trial in the background, acknowledge it, and accept it."""
        underWay.append(delivery)
        isAborted = underWay is self._aborted

        def acknowledge() -> None:
            trial = {"trialId": delivery["trialId"]}
            self._services.link.send(CommandName.ACKNOWLEDGE_TRIAL, trial)

        try:
            stored = yield lambda: store(delivery)
        except DeletedTrialError:
            # Its trainee was deleted for good: it must not be offered forever.
            acknowledge()
        except Exception as error:
            refusal = ABORTED_REFUSAL if isAborted else REFUSAL
            self.report(refusal.format(error=error), "aborted" if isAborted else "")
        else:
            acknowledge()
            if not isAborted:
                self._accept(*stored)
            elif stored.is_kept:
                self.abortedKept.emit(stored)
        finally:
            underWay.remove(delivery)
            self._storeNext()

    def _storeAborted(self, delivery: Delivery) -> AbortedTrial:
        record = record_from_json(AbortedTrial, delivery)
        self._services.inStudy(lambda study: study.add_aborted(record, delivery))
        return record

    def isBeingScored(self, trialId: str) -> bool:
        return _isIn(self._underWay, {"trialId": trialId}) or trialId in self._beingScored

    def _followTraining(self, state: Mapping[str, Any]) -> None:
        self._playing = readStatus(state)
        if self._retryAt is not None and time.monotonic() >= self._retryAt:
            self._services.converse(self._resuming())

    def _resumeAll(self) -> None:
        self._refused.clear()
        self._services.converse(self._resuming())

    def _store(
        self, delivery: Delivery
    ) -> tuple[TrialRecord | DrillRecord, TrialAnalysis | InputError | None]:
        isUnderWay = str(delivery.get("trialId")) in self._beingScored
        analyze = self._analyze
        return self._services.inStudy(lambda s: store_delivered(delivery, s, analyze, isUnderWay))

    def _accept(
        self, record: TrialRecord | DrillRecord, analysis: TrialAnalysis | InputError | None
    ) -> None:
        """Score a trial that is stored and acknowledged; a drill has its score."""
        if isinstance(analysis, InputError):
            self._reportUnscored(analysis)
        if record.trial_id not in self.received:
            self.received.append(record.trial_id)
            isDrill = isinstance(record, DrillRecord)
            (self.drillKept if isDrill else self.trialKept).emit(record)
        if isinstance(analysis, TrialAnalysis) and record.trial_id not in self._beingScored:
            self._services.converse(self._scoring(analysis, self.report))
            self._services.work.later(lambda: self._show(analysis))

    def _analyze(self, record: TrialRecord) -> TrialAnalysis:
        scenario = self._services.findScenario(record.scenario)
        return self._services.runWanted(REGISTER, record, scenario, self._cohort)

    def _reportUnscored(self, reason: object) -> None:
        self.report(_("A trial is stored but cannot be scored: {error}").format(error=reason))

    def _show(self, analysis: TrialAnalysis) -> None:
        """Show a trial in the scene, unless another one is being played there."""
        if self._playing.isOpen and self._playing.trialId != analysis.record.trial_id:
            return
        scenario = self._services.findScenario(analysis.record.scenario)
        showTrial(self._services.scene, scenario, analysis, self._services.work.changeScene)

    def _resuming(self) -> Steps:
        """Score the trials that were not scored before connection or study were lost.

        If all were scored at once, a trial that arrives meanwhile would wait for all of them.
        """
        self._retryAt = None
        try:
            self._unscored = deque((yield lambda: self._services.inStudy(Study.unrevealed)))
        except Exception as error:
            self._noteBusy(error)
            self.report(str(error))
            return
        while self._unscored and self._services.link.seen.isOpen:
            record = self._unscored.popleft()
            # Since the list was read it may have been scored.
            if record.trial_id in self._beingScored | self._scored | self._refused:
                continue
            self._beingScored.add(record.trial_id)
            try:
                analysis = yield partial(self._analyze, record)
            except Exception as error:
                self._beingScored.discard(record.trial_id)
                self._reportUnscored(error)
            else:
                # A trial of another simulator does not concern this one.
                yield from self._scoring(analysis, logging.info)

    def _scoring(self, analysis: TrialAnalysis, report: Callable[[str], None]) -> Steps:
        trialId = analysis.record.trial_id
        self._beingScored.add(trialId)
        try:
            scored = yield from self._revealing(analysis)
        except Exception as error:
            self._beingScored.discard(trialId)
            if not self._noteBusy(error):
                self._refused.add(trialId)
            report(_("The trial was not scored: {error}").format(error=error))
        else:
            self._beingScored.discard(trialId)
            self._scored.add(trialId)
            self.trialScored.emit(scored)

    def _noteBusy(self, error: Exception) -> bool:
        """Return whether the study was only locked or unreachable; it is tried again then."""
        isBusy = isinstance(error, StudyBusyError)
        if isBusy:
            self._retryAt = time.monotonic() + RETRY_S
        return isBusy

    def _revealing(self, analysis: TrialAnalysis) -> Steps:
        """Have a registered trial that is in the study revealed and scored; return it scored.

        If that is interrupted, the truth is not stored, and all of it is done again over the next
        connection, with the same outcome.
        """
        trialId, ask = analysis.record.trial_id, partial(Question, timeoutS=ANSWER_TIMEOUT_S)
        answer = yield ask(CommandName.SUBMIT_REGISTRATION, analysis.arguments(trialId))
        truth = record_from_json(RevealedTruth, answer, "The simulator's answer")

        def storeTruth(study: Study) -> None:
            study.add_results(trialId, truth=truth)

        journal = None
        if (yield lambda: self._services.inStudy(checks_journals)):
            journal = yield from _fetchingJournal(trialId)
        try:
            scored = yield lambda: self._storeScore(analysis, truth, journal)
        except StudyBusyError:
            raise
        except Exception:
            # It can never be scored, and is not requested again.
            yield lambda: self._services.inStudy(storeTruth)
            raise
        yield ask(CommandName.TRIAL_SCORED, score_arguments(scored))
        yield lambda: self._services.inStudy(storeTruth)
        return scored

    def _storeScore(
        self, analysis: TrialAnalysis, truth: RevealedTruth, journal: bytes | None
    ) -> TrialAnalysis:
        record, services = analysis.record, self._services
        with services.openStudy() as study:
            scenario, records = services.findScenario(record.scenario), services.records
            given = analysis, truth, scenario, score_references(study), records, journal
            scored = services.runWanted(SCORE, *given)
            study.add_results(record.trial_id, score=scored.score, procedure=scored.procedure)
            return with_progress(scored, study)


def _isIn(deliveries: Iterable[Delivery], delivery: Delivery) -> bool:
    return any(each.get("trialId") == delivery.get("trialId") for each in deliveries)


def _fetchingJournal(trialId: str) -> Steps:
    """Fetch the journal of a trial whose truth is revealed, piece by piece; return its bytes."""
    journal, start = b"", 0
    while start is not None:
        arguments = {"trialId": trialId, "start": start}
        answer = yield Question(CommandName.GET_JOURNAL, arguments, ANSWER_TIMEOUT_S)
        text, start = answer.get("text"), answer.get("next")
        if not isinstance(text, str) or not text.isascii():
            raise InputError(_("The simulator's answer to GetJournal must hold its text."))
        journal += text.encode("ascii")
        isNext = text and start == len(journal) and start <= MAX_JOURNAL_BYTES
        if start is not None and not isNext:
            raise InputError(_("The pieces of the trial's journal do not follow on each other."))
    return journal
