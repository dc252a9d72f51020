"""From a trial's registration to its score, in the order in which nobody can cheat.

First the registration is submitted, which makes it final; then the simulator tells the truth; then
the score is made of it, told, and kept. Wherever that is cut short, the truth is not kept, and all
of it is done again over the next connection, with the same outcome.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.protocol import CommandName
from rastrainer.revealed_truth import RevealedTruth
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link import Link
from rastrainer.study import Study
from rastrainer.trial_analysis import TrialAnalysis
from rastrainer.trial_record import TrialRecord
from rastrainer.trial_review import with_progress

ANSWER_TIMEOUT_S = 60.0
"""Nobody waits for these answers, and what is given up would be asked for again only over the next
connection: a busy simulator gets the time it needs."""

Analyze = Callable[[TrialRecord, Study, RevealedTruth], TrialAnalysis]
End = Callable[[Exception], None]


class TrialScoring:
    """Has registered trials revealed and scored."""

    def __init__(
        self, link: Link, work: BackgroundWork, openStudy: Callable[[], Study], analyze: Analyze
    ) -> None:
        """Prepare.

        Args:
            link: to the simulator.
            work: in which trials are scored and kept.
            openStudy: opens the study, in any thread; it may wait for a lock there.
            analyze: scores a trial whose truth is known.
        """
        self._link = link
        self._work = work
        self._openStudy = openStudy
        self._analyze = analyze

    def begin(
        self, analysis: TrialAnalysis, take: Callable[[TrialAnalysis], None], end: End
    ) -> None:
        """Score a registered trial that is in the study.

        Args:
            analysis: its registration.
            take: is given the analysis with truth and score, once they are in the study.
            end: is given why it came to nothing.
        """

        def score(answer: Mapping[str, Any]) -> None:
            truth = RevealedTruth.from_json(answer)
            self._work.do(
                lambda: self._scored(analysis.record, truth),
                tell,
                lambda error: self._work.do(
                    lambda: self._keepTruth(analysis.record, truth), lambda _none: end(error), end
                ),
            )

        def tell(scored: TrialAnalysis) -> None:
            self._ask(CommandName.TRIAL_SCORED, _scoreOf(scored), lambda _answer: keep(scored), end)

        def keep(scored: TrialAnalysis) -> None:
            self._work.do(
                lambda: self._keepTruth(scored.record, scored.truth),
                lambda _none: take(scored),
                end,
            )

        self._ask(CommandName.SUBMIT_REGISTRATION, _registrationOf(analysis), score, end)

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

    def _scored(self, record: TrialRecord, truth: RevealedTruth) -> TrialAnalysis:
        with self._openStudy() as study:
            analysis = self._analyze(record, study, truth)
            study.add_results(record.trial_id, score=analysis.score)
            return with_progress(analysis, study)

    def _keepTruth(self, record: TrialRecord, truth: RevealedTruth) -> None:
        with self._openStudy() as study:
            study.set_truth(record.trial_id, truth.true_tre_mm, truth.head_to_world)


def _registrationOf(analysis: TrialAnalysis) -> dict[str, Any]:
    return {
        "trialId": analysis.record.trial_id,
        "matrix": [float(value) for value in analysis.rigid.matrix.ravel()],
        "freMm": analysis.rigid.fre_mm,
        "expectedTreMm": analysis.expected_tre.expected_mm,
    }


def _scoreOf(analysis: TrialAnalysis) -> dict[str, Any]:
    score, progress = analysis.score, analysis.feedback.progress
    published = analysis.published_score
    return {
        "trialId": analysis.record.trial_id,
        "score": score.score,
        "details": {
            "residualsMm": analysis.rigid.residuals_mm.tolist(),
            "treIntervalMm": list(analysis.expected_tre.interval_mm),
            "regionTreMm": score.measures.tre_mm,
            "timeDesirability": score.time_desirability,
            "accuracyDesirability": score.accuracy_desirability,
            "safetyDesirability": score.safety_desirability,
            "isAccurate": score.is_accurate,
            "isSafe": score.is_safe,
            "ctps": None if published is None else published.published,
            "warnings": [warning.message for warning in analysis.rigid.warnings],
            "passMark": None if progress is None else progress.pass_mark,
            "feedback": [each.to_json() for each in analysis.feedback.short_sentences],
        },
    }
