"""What happens when a finished trial arrives: kept, acknowledged, registered, scored, told.

Nothing is lost and nothing counts twice, whatever is cut on the way. The simulator offers a trial
until it is acknowledged, and it is acknowledged only when it is in the study; what is in the study
without its truth is scored again over the next connection.
"""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rastrainer.ctps import Trial
from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.protocol import OPEN_PHASES, CommandName
from rastrainer.scenario import Scenario
from rastrainer.slicer.link import Link
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _
from rastrainer.slicer.trial_scene import showTrial
from rastrainer.study import DeletedTrialError, Study
from rastrainer.trial_analysis import TrialAnalysis
from rastrainer.trial_record import TrialRecord
from rastrainer.trial_results import RevealedTruth
from rastrainer.trial_review import review, with_progress

SCORED_TIMEOUT_S = 60.0
"""Nobody waits for this answer, and one that is given up would be asked for again only over the
next connection: a busy simulator gets the time it needs."""


@dataclass(frozen=True)
class ScoredTrial:
    """A trial with its numbers and what the simulator has revealed about it."""

    analysis: TrialAnalysis
    truth: RevealedTruth


class TrialDesk:
    """Takes in the trials that a link hands over.

    Attributes:
        trialKept: emits each `TrialRecord` that comes in, once it is in the study.
        trialScored: emits each `ScoredTrial`, once its truth is in the study.
        problemFound: emits a sentence about a trial that could not be kept or scored.
        received: UUIDs of the trials that came in and are safe, in their order.
    """

    def __init__(
        self,
        scene: Any,
        link: Link,
        findScenario: Callable[[str], Scenario],
        openStudy: Callable[[], Study],
        cohort: Sequence[Trial] = (),
        records: Path | None = None,
    ) -> None:
        """Take in the trials of a link.

        Args:
            scene: the scene.
            link: to the simulator.
            findScenario: gives the scenario of a name.
            openStudy: opens the study when it is first needed.
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
        self._cohort = cohort
        self._records = records
        self._study: Study | None = None
        self._told: set[str] = set()
        self._untold: deque[TrialRecord] = deque()
        self._state: Mapping[str, Any] = {}
        self._lastProblem = ""
        link.trialCompleted.connect(self._receive)
        link.stateChanged.connect(self._followTraining)
        link.opened.connect(self._resume)

    def close(self) -> None:
        """Listen to the link no more and close the study."""
        self._link.trialCompleted.disconnect(self._receive)
        self._link.stateChanged.disconnect(self._followTraining)
        self._link.opened.disconnect(self._resume)
        self.closeStudy()

    def closeStudy(self) -> None:
        """Close the study; the next trial goes into the one that is to be opened then."""
        if self._study is not None:
            self._study.close()
            self._study = None

    def _followTraining(self, state: Mapping[str, Any]) -> None:
        self._state = state

    def _receive(self, value: Mapping[str, Any]) -> None:
        """Keep a delivered trial, then acknowledge it, then go on with it."""
        try:
            record = TrialRecord.from_json(value)
            study = self._openedStudy()
            analysis = self._analyze(record)
            isRevealed = _keep(value, record, analysis, study)
        except DeletedTrialError:
            # Its trainee is gone for good: it must not be offered for ever.
            self._acknowledge(record)
            return
        except InputError as error:
            self._complain(_("A trial could not be kept: {error}").format(error=error))
            return
        self._acknowledge(record)
        if record.trial_id not in self.received:
            self.received.append(record.trial_id)
            self.trialKept.emit(record)
        if analysis is not None and not isRevealed and record.trial_id not in self._told:
            self._show(analysis)
            self._tellScore(with_progress(analysis, study), self._complain)

    def _acknowledge(self, record: TrialRecord) -> None:
        self._link.send(CommandName.ACKNOWLEDGE_TRIAL, {"trialId": record.trial_id})

    def _analyze(self, record: TrialRecord) -> TrialAnalysis | None:
        try:
            scenario = self._findScenario(record.scenario)
            return review(record, scenario, self._openedStudy(), self._records, self._cohort)
        except InputError as error:
            self._complain(_("A trial is kept but cannot be scored: {error}").format(error=error))
            return None

    def _resume(self) -> None:
        """Go on with trials whose score was told to nobody before the connection was cut."""
        try:
            self._untold = deque(self._openedStudy().unrevealed())
        except InputError as error:
            self._complain(str(error))
            return
        self._resumeNext()

    def _resumeNext(self) -> None:
        """Score and tell one trial; the next follows its answer.

        Scoring takes a moment. If all were scored at once, the link would go unread for so long
        that their answers, and then the connection, would be given up.
        """
        while self._untold and self._link.isOpen:
            record = self._untold.popleft()
            if record.trial_id in self._told:
                continue
            analysis = self._analyze(record)
            if analysis is not None:
                # A trial of another simulator is none of this one's business.
                self._tellScore(analysis, logging.info, self._resumeNext)
                return

    def _show(self, analysis: TrialAnalysis) -> None:
        """Show a trial in the scene, unless another one is being played there."""
        isOther = self._state.get("trialId") != analysis.record.trial_id
        if isOther and self._state.get("phase") in OPEN_PHASES:
            return
        showTrial(self._scene, self._findScenario(analysis.record.scenario), analysis)

    def _tellScore(
        self,
        analysis: TrialAnalysis,
        complain: Callable[[str], None],
        goOn: Callable[[], None] = lambda: None,
    ) -> None:
        trialId = analysis.record.trial_id
        self._told.add(trialId)

        def takeAnswer(reply: Reply) -> None:
            self._told.discard(trialId)
            try:
                if not reply.ok:
                    raise InputError(reply.error)
                truth = RevealedTruth.from_json(reply.data)
                self._openedStudy().set_truth(trialId, truth.true_tre_mm, truth.head_to_world)
            except InputError as error:
                complain(_("The score was not taken: {error}").format(error=error))
            else:
                self.trialScored.emit(ScoredTrial(analysis, truth))
            goOn()

        arguments = _scoreArguments(analysis)
        self._link.send(CommandName.TRIAL_SCORED, arguments, takeAnswer, SCORED_TIMEOUT_S)

    def _openedStudy(self) -> Study:
        if self._study is None:
            self._study = self._openStudy()
        return self._study

    def _complain(self, sentence: str) -> None:
        """Tell a problem once, though the trial is offered every two seconds."""
        if sentence != self._lastProblem:
            self._lastProblem = sentence
            self.problemFound.emit(sentence)


def _keep(
    value: Mapping[str, Any], record: TrialRecord, analysis: TrialAnalysis | None, study: Study
) -> bool:
    """Store a trial with its results, once; return whether its truth is known already."""
    if analysis is None:
        study.add_trial(value)
    else:
        study.add_trial(value, analysis.fits.values(), analysis.target_errors, analysis.score)
    return study.trial(record.trial_id).true_tre_mm is not None


def _scoreArguments(analysis: TrialAnalysis) -> dict[str, Any]:
    published, progress = analysis.published_score, analysis.feedback.progress
    return {
        "trialId": analysis.record.trial_id,
        "matrix": [float(value) for value in analysis.rigid.matrix.ravel()],
        "freMm": analysis.rigid.fre_mm,
        "expectedTreMm": analysis.expected_tre.expected_mm,
        "score": analysis.score.score,
        "details": {
            "residualsMm": analysis.rigid.residuals_mm.tolist(),
            "treIntervalMm": list(analysis.expected_tre.interval_mm),
            "timeDesirability": analysis.score.time_desirability,
            "accuracyDesirability": analysis.score.accuracy_desirability,
            "ctps": None if published is None else published.published,
            "warnings": [warning.message for warning in analysis.rigid.warnings],
            "passMark": None if progress is None else progress.pass_mark,
            "feedback": [each.to_json() for each in analysis.feedback.short_sentences],
        },
    }
