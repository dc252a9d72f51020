"""The score of a trial, computed in an order that rules out cheating.

The registration is submitted, which makes it final; the simulator reveals the truth; the score is
computed, sent and stored. If that is interrupted, the truth is not stored, and all of it is done
again over the next connection, with the same outcome.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.protocol import CommandName
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer.study.database.database import StudyBusyError
from rastrainer.study.database.study import Study
from rastrainer.study.delivered_trial import with_progress
from rastrainer.trial.analysis import (
    RevealedTruth,
    TrialAnalysis,
    registration_arguments,
    score_arguments,
)
from rastrainer.trial.record import TrialRecord

ANSWER_TIMEOUT_S = 60.0
"""No user waits for these answers, and what times out is requested again only over the next
connection: a busy simulator gets the time it needs."""

Score = Callable[[TrialAnalysis, Study, RevealedTruth], TrialAnalysis]
End = Callable[[Exception], None]


class TrialScoring:
    """Has registered trials revealed and scored."""

    def __init__(
        self, link: Link, work: BackgroundWork, openStudy: Callable[[], Study], score: Score
    ) -> None:
        """Prepare.

        Args:
            link: to the simulator.
            work: in which trials are scored and stored.
            openStudy: opens the study, in any thread; it may wait for a lock there.
            score: scores a registered trial whose truth is known.
        """
        self._link = link
        self._work = work
        self._openStudy = openStudy
        self._score = score

    def begin(
        self, analysis: TrialAnalysis, take: Callable[[TrialAnalysis], None], end: End
    ) -> None:
        """Score a registered trial that is in the study.

        Args:
            analysis: its registration.
            take: receives the analysis with truth and score, once they are in the study.
            end: receives the reason for a failure.
        """

        def score(answer: Mapping[str, Any]) -> None:
            truth = RevealedTruth.from_json(answer)
            self._work.do(
                lambda: self._scored(analysis, truth),
                lambda scored: report(scored, truth),
                lambda error: refuse(error, truth),
            )

        def refuse(error: Exception, truth: RevealedTruth) -> None:
            """Store the truth of a trial that can never be scored; others are requested again."""
            if isinstance(error, StudyBusyError):
                end(error)
                return
            self._work.do(
                lambda: self._keepTruth(analysis.record, truth), lambda _none: end(error), end
            )

        def report(scored: TrialAnalysis, truth: RevealedTruth) -> None:
            self._ask(
                CommandName.TRIAL_SCORED,
                score_arguments(scored),
                lambda _answer: keep(scored, truth),
                end,
            )

        def keep(scored: TrialAnalysis, truth: RevealedTruth) -> None:
            self._work.do(
                lambda: self._keepTruth(scored.record, truth), lambda _none: take(scored), end
            )

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

    def _scored(self, analysis: TrialAnalysis, truth: RevealedTruth) -> TrialAnalysis:
        with self._openStudy() as study:
            scored = self._score(analysis, study, truth)
            study.add_results(
                scored.record.trial_id, score=scored.score, procedure=scored.procedure
            )
            return with_progress(scored, study)

    def _keepTruth(self, record: TrialRecord, truth: RevealedTruth) -> None:
        with self._openStudy() as study:
            study.set_truth(record.trial_id, truth.true_tre_mm, truth.head_to_world)
