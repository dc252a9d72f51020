"""Feedback on one trial, alone and among the trainee's earlier trials: as data and as sentences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.motion.trajectory import Trajectory
from rastrainer.number_text import fixed
from rastrainer.registration.registration import Registration
from rastrainer.trial import scoring
from rastrainer.trial.advice import Advice, TouchFinding, advise, touch_findings
from rastrainer.trial.lc_cusum import LcCusum, lc_cusum, lc_cusum_limit
from rastrainer.trial.trial_row import TrialRow
from rastrainer.trial.wording import Sentence, say

ADEQUATE_FAILURES, INADEQUATE_FAILURES = 0.05, 0.4
"""A competent trainee fails in 5 of 100 trials, an incompetent one in 40."""
TRAINING_TRIALS = 30
"""Within which an incompetent trainee is called competent at most once in 20; the sentence gives
the risk of the trials that there really are."""


@dataclass(frozen=True)
class TraineeProgress:
    """A trainee's progress including this trial; the mark is None without one for its method."""

    pass_mark: float | None
    sentences: tuple[Sentence, ...]


def progress_of(
    past: Sequence[TrialRow], trial_id: str, pass_mark: float | None
) -> TraineeProgress:
    """Return the progress at a trial, compared with trials of its task, mode and method.

    `past` has all scored trials of the trainee without trial runs, and aborted trials that are not
    passed, in order; later trials are ignored. Competence is that in all tasks of the mode.
    """
    ids = ["" if other.is_aborted else other.trial_id for other in past]
    if trial_id not in ids:
        raise InputError("Progress needs a scored trial of the trainee's own history.")
    until = past[: ids.index(trial_id) + 1]
    trial = until[-1]
    in_mode = [other for other in until if (other.mode, other.method) == (trial.mode, trial.method)]
    scores = [each.score for each in in_mode if each.task == trial.task and not each.is_aborted]
    has_others = any(
        (other.mode, other.task) == (trial.mode, trial.task) and not other.is_aborted
        for other in until[:-1]
    )
    about_scores = _about_scores(scores, has_others)
    if not trial.acceptable:
        about_mark = say("unacceptable")
    elif pass_mark is None:
        about_mark = say("no mark")
    elif trial.score >= pass_mark:
        about_mark = say("passed", mark=pass_mark)
    else:
        about_mark = say("not passed", points=pass_mark - trial.score, mark=pass_mark)
    if pass_mark is None:
        return TraineeProgress(None, (about_scores, about_mark))
    failures = [not scoring.passes(other.score, other.acceptable, pass_mark) for other in in_mode]
    about_competence = _about_competence(competence_of(failures), len(failures))
    return TraineeProgress(pass_mark, (about_scores, about_mark, about_competence))


def competence_of(failures: Sequence[bool]) -> LcCusum:
    limit = lc_cusum_limit(ADEQUATE_FAILURES, INADEQUATE_FAILURES, TRAINING_TRIALS)
    return lc_cusum(failures, ADEQUATE_FAILURES, INADEQUATE_FAILURES, limit)


def _about_scores(scores: Sequence[float], has_others: bool) -> Sentence:
    if len(scores) == 1:
        return say("first by this method" if has_others else "first trial")
    earlier = scores[:-1][-3:]
    change = scores[-1] - float(np.mean(earlier))
    key = "more points" if change >= 0 else "less points"
    best = say("best") if scores[-1] > max(scores[:-1]) else ""
    if len(earlier) == 1:
        return say(f"{key} than last", points=abs(change), best=best)
    return say(key, points=abs(change), trials=len(earlier), best=best)


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


MAX_SHORT = 4
"""Sentences that are read at a glance next to the figures of a result."""


@dataclass(frozen=True)
class TrialFeedback:
    """The feedback shown to a trainee after a trial.

    `paused_s` is how long it was paused in all, as far as that is known, and `skin` how the skin
    had shifted, and what that did; empty if it had not.
    """

    score: scoring.TrialScore | None
    touches: tuple[TouchFinding, ...]
    advice: tuple[Advice, ...]
    progress: TraineeProgress | None = None
    paused_s: float = 0.0
    skin: tuple[Sentence, ...] = ()

    @property
    def worst(self) -> TouchFinding:
        """The touch with the largest error; its `replay_s` is what to look at again."""
        return max(self.touches, key=lambda touch: touch.residual_mm)

    @property
    def score_sentences(self) -> tuple[str, ...]:
        score, sentences = self.score, []
        if score is not None:
            beyond = "." if score.acceptable else ": not acceptable."
            seconds = fixed(score.measures.completion_time_s, 0)
            sentences = [
                f"Score {fixed(score.score, 0)} of 100{beyond}",
                f"Time: {seconds} s, worth {fixed(100 * score.time_desirability, 0)} of 100.",
                _accuracy_sentence(score),
                _safety_sentence(score),
            ]
        if self.paused_s > scoring.LONG_PAUSE_S:
            sentences.append(
                f"Paused for {fixed(self.paused_s, 0)} s in all, which the score leaves out: "
                "compare it with care to trials that were played in one go."
            )
        return tuple(sentences)

    @property
    def touch_sentences(self) -> tuple[Sentence, ...]:
        """The outliers, the worst first, or that there are none."""
        outliers = sorted((t for t in self.touches if t.is_outlier), key=lambda t: -t.residual_mm)
        if not outliers:
            return (say("no touch"),)
        return tuple(touch.sentence for touch in outliers)

    @property
    def sentences(self) -> tuple[str, ...]:
        progress = () if self.progress is None else self.progress.sentences
        improve = tuple(f"{i}. {a.sentence}" for i, a in enumerate(self.advice, start=1))
        scored = (*self.score_sentences, *self.skin)
        return (*scored, *self.touch_sentences, *improve, *progress)

    @property
    def short_sentences(self) -> list[Sentence]:
        """The help for the next trial: the worst touch, the first advice, the trend.

        Whether the trial is passed is said above them, and competence is for instructors.
        """
        trend = () if self.progress is None else self.progress.sentences[:1]
        first = (each.sentence for each in self.advice[:1])
        return [*self.skin, self.touch_sentences[0], *first, *trend]


def trial_feedback(
    registration: Registration,
    normals: np.ndarray,
    motion: Mapping[str, float],
    trajectory: Trajectory | None,
) -> TrialFeedback:
    """Return the feedback on a trial without its score.

    `normals` are the skin's outward unit normals (n, 3) at the fiducials, RAS. The metric
    `path_efficiency` adds advice on detours.
    """
    findings = touch_findings(registration, normals, trajectory)
    return TrialFeedback(
        score=None,
        touches=findings,
        advice=advise(None, findings, motion),
        paused_s=motion.get("pause_time_s", 0.0),
    )


def _accuracy_sentence(score: scoring.TrialScore) -> str:
    bias_mm, limit_mm = score.measures.common_bias_mm, score.reference.limit_mm
    bias = "" if bias_mm is None else f" and {fixed(bias_mm, 2)} mm common to all touches"
    beyond = []
    if not score.is_accurate:
        beyond.append(f"more than {limit_mm:g} mm of error")
    if score.is_unbiased is False:
        beyond.append(f"more than {scoring.COMMON_BIAS_LIMIT_MM:g} mm common to all touches")
    end = f"; {' and '.join(beyond)} is not acceptable." if beyond else "."
    return (
        f"Accuracy: {fixed(score.measures.tre_mm, 2)} mm true error in the brain{bias}, worth "
        f"{fixed(100 * score.accuracy_desirability, 0)} of 100{end}"
    )


def _safety_sentence(score: scoring.TrialScore) -> str:
    measures = score.measures
    beyond = (
        "."
        if score.is_safe
        else f"; more than {scoring.CONTACT_LIMIT_S:g} s, {scoring.CONTACT_PATH_LIMIT_MM:g} mm or "
        f"{scoring.DEPTH_LIMIT_MM:g} mm deep is not acceptable."
    )
    contact = ""
    if measures.contact_time_s > 0:
        contact = (
            f"{fixed(measures.contact_time_s, 1)} s and {fixed(measures.contact_path_mm, 0)} mm of "
            "unintended contact, "
        )
    return (
        f"Safety: {contact}pressed {fixed(measures.pressing_depth_mm, 1)} mm deep, worth "
        f"{fixed(100 * score.safety_desirability, 0)} of 100{beyond}"
    )
