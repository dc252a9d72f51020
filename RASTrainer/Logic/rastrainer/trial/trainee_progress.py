"""A trial among the trainee's earlier ones, and against pass mark and competence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.statistics.competence import LcCusum, lc_cusum, lc_cusum_limit
from rastrainer.trial.aborted_trial import AbortedTrial
from rastrainer.trial.scoring import passes
from rastrainer.trial.wording import Sentence, say

ADEQUATE_FAILURES, INADEQUATE_FAILURES = 0.05, 0.4
"""A competent trainee fails in 5 of 100 trials, an incompetent one in 40."""
TRAINING_TRIALS = 30
"""Within which an incompetent trainee is called competent at most once in 20; the sentence gives
the risk of the trials that there really are."""


@dataclass(frozen=True)
class PastTrial:
    """A scored trial, as a trainee's progress is computed from it.

    Attributes:
        trial_id: UUID.
        task, mode: As recorded.
        completion_time_s: As recorded.
        score: The latest, above 0 up to 100.
        acceptable: Whether it was within all limits of its score.
        is_aborted: Whether it was aborted after a touch: not passed, without time or score.
        score_version: Of the score; scores of different versions are not compared.
    """

    trial_id: str
    task: str
    mode: str
    completion_time_s: float
    score: float
    acceptable: bool
    is_aborted: bool = False
    score_version: str = ""

    @classmethod
    def failed(cls, record: AbortedTrial) -> PastTrial:
        """Return an aborted trial that counts as not passed."""
        return cls(
            record.trial_id,
            record.task,
            record.mode,
            record.elapsed_s,
            score=0.0,
            acceptable=False,
            is_aborted=True,
        )


@dataclass(frozen=True)
class TraineeProgress:
    """A trainee's progress including this trial.

    Attributes:
        scores: Of the trials of this task in this mode, in order; like competence, without scores
            of other versions.
        pass_mark: Score that passes; None without one for scores of this version.
        competence: LC-CUSUM over the trainee's trials of all tasks in this mode; aborted ones count
            as not passed. None without a pass mark.
        sentences: The same in words.
    """

    scores: tuple[float, ...]
    pass_mark: float | None
    competence: LcCusum | None
    sentences: tuple[Sentence, ...]


def progress_of(
    past: Sequence[PastTrial], trial_id: str, pass_mark: float | None
) -> TraineeProgress:
    """Return the progress at a trial.

    Args:
        past: All scored trials of the trainee without trial runs, and aborted ones that count as
            not passed, in order; later ones are ignored.
        trial_id: Of one of them.
        pass_mark: Score that passes; None without one for scores of the trial's version.

    Raises:
        InputError: the trial is not among them.
    """
    ids = ["" if other.is_aborted else other.trial_id for other in past]
    if trial_id not in ids:
        raise InputError("Progress needs a scored trial of the trainee's own history.")
    until = past[: ids.index(trial_id) + 1]
    trial = until[-1]
    in_mode = [other for other in until if other.mode == trial.mode and _compares(other, trial)]
    played = [
        other
        for other in until
        if (other.mode, other.task) == (trial.mode, trial.task) and not other.is_aborted
    ]
    scores = tuple(other.score for other in played if _compares(other, trial))
    is_best = len(scores) > 1 and scores[-1] > max(scores[:-1])
    about_scores = _about_scores(scores, is_best, len(scores) < len(played))
    if pass_mark is None:
        about_mark = say("no mark") if trial.acceptable else say("unacceptable")
        return TraineeProgress(scores, None, None, (about_scores, about_mark))
    failures = [not passes(other.score, other.acceptable, pass_mark) for other in in_mode]
    competence = competence_of(failures)
    sentences = (
        about_scores,
        _about_mark(trial.score, trial.acceptable, pass_mark),
        _about_competence(competence, len(failures)),
    )
    return TraineeProgress(scores, pass_mark, competence, sentences)


def competence_of(failures: Sequence[bool]) -> LcCusum:
    """Return the LC-CUSUM of a trainee in one mode; `failures` are in order."""
    limit = lc_cusum_limit(ADEQUATE_FAILURES, INADEQUATE_FAILURES, TRAINING_TRIALS)
    return lc_cusum(failures, ADEQUATE_FAILURES, INADEQUATE_FAILURES, limit)


def _compares(other: PastTrial, trial: PastTrial) -> bool:
    """Return whether two scores are comparable; an aborted trial has none."""
    return other.is_aborted or other.score_version == trial.score_version


def _about_scores(scores: Sequence[float], is_best: bool, has_others: bool) -> Sentence:
    if len(scores) == 1:
        return say("first of this score" if has_others else "first trial")
    earlier = scores[:-1][-3:]
    change = scores[-1] - float(np.mean(earlier))
    key = "more points" if change >= 0 else "less points"
    best = say("best") if is_best else ""
    if len(earlier) == 1:
        return say(f"{key} than last", points=abs(change), best=best)
    return say(key, points=abs(change), trials=len(earlier), best=best)


def _about_mark(score: float, acceptable: bool, pass_mark: float) -> Sentence:
    if not acceptable:
        return say("unacceptable")
    if score >= pass_mark:
        return say("passed", mark=pass_mark)
    return say("not passed", points=pass_mark - score, mark=pass_mark)


def _about_competence(chart: LcCusum, trials: int) -> Sentence:
    if chart.competent_at is None:
        return say("not competent", share=100 * chart.scores[-1] / chart.limit, trials=trials)
    return say(
        "competent",
        number=chart.competent_at,
        failing=100 * INADEQUATE_FAILURES,
        risk=100 * chart.false_discovery,
        trials=trials,
    )
