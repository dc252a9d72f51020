"""Feedback on one trial, as data and as sentences for any view."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rastrainer.motion.trajectory import Trajectory
from rastrainer.number_text import fixed
from rastrainer.registration.registration import Registration
from rastrainer.trial.advice import Advice, TouchFinding, advise, touch_findings
from rastrainer.trial.scoring import (
    COMMON_BIAS_LIMIT_MM,
    CONTACT_LIMIT_S,
    CONTACT_PATH_LIMIT_MM,
    DEPTH_LIMIT_MM,
    FIRST_SCORE_VERSION,
    LONG_PAUSE_S,
    SafetyMeasures,
    TrialScore,
)
from rastrainer.trial.trainee_progress import TraineeProgress
from rastrainer.trial.trueness import CommonBias
from rastrainer.trial.wording import Sentence, say

MAX_SHORT = 6
"""Sentences that fit beside the figures of a result at 1280 × 720."""


@dataclass(frozen=True)
class TrialFeedback:
    """What a trainee is shown after a trial.

    Attributes:
        score: With its parts; None where the trial has none.
        touches: Every touch, in the order of touching.
        worst: The touch with the largest error; its `replay_s` is what to look at again.
        advice: Up to three things to improve, the first first.
        progress: None where there is no history.
        paused_s: How long the trial was paused in all, as far as that is known.
        skin: How the skin had shifted, and what that did; None where it had not.
    """

    score: TrialScore | None
    touches: tuple[TouchFinding, ...]
    worst: TouchFinding
    advice: tuple[Advice, ...]
    progress: TraineeProgress | None
    paused_s: float = 0.0
    skin: Sentence | None = None

    @property
    def skin_sentences(self) -> tuple[Sentence, ...]:
        """How the skin had shifted; none where it had not."""
        return () if self.skin is None else (self.skin,)

    @property
    def score_sentences(self) -> tuple[str, ...]:
        """The score and its parts, as far as known."""
        score, sentences = self.score, []
        if score is not None:
            beyond = "." if score.acceptable else ": not acceptable."
            seconds = fixed(score.measures.completion_time_s, 0)
            sentences = [
                f"Score {fixed(score.score, 0)} of 100{beyond}",
                f"Time: {seconds} s, worth {fixed(100 * score.time_desirability, 0)} of 100.",
                _accuracy_sentence(score),
            ]
            safety = score.measures.safety
            if safety is not None and score.safety_desirability is not None:
                is_safe = score.is_safe is not False
                sentences.append(_safety_sentence(safety, score.safety_desirability, is_safe))
        if self.paused_s > LONG_PAUSE_S:
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
        """All sentences in display order."""
        progress = () if self.progress is None else self.progress.sentences
        improve = tuple(f"{i}. {a.sentence}" for i, a in enumerate(self.advice, start=1))
        scored = (*self.score_sentences, *self.skin_sentences)
        return (*scored, *self.touch_sentences, *improve, *progress)

    @property
    def short_sentences(self) -> list[Sentence]:
        """The sentences that fit beside the score: worst touch, advice, and progress.

        Pass mark and competence come last and are always included.
        """
        progress = () if self.progress is None else self.progress.sentences
        touch = self.touch_sentences[:1]
        others = [*self.skin_sentences, *touch, *(a.sentence for a in self.advice)]
        return [*others, *progress[max(0, len(others) + len(progress) - MAX_SHORT) :]]


def trial_feedback(
    score: TrialScore | None,
    registration: Registration,
    normals: np.ndarray | None = None,
    motion: Mapping[str, float] | None = None,
    trajectory: Trajectory | None = None,
    progress: TraineeProgress | None = None,
    bias: CommonBias | None = None,
) -> TrialFeedback:
    """Return the feedback on a trial; what is not known is left out.

    Args:
        score: Of the trial; None where it has none.
        registration: That was scored.
        normals: (n, 3) float, outward unit normals of the skin at the fiducials, RAS.
        motion: Motion metrics; with `path_efficiency`, detours are advised on too.
        trajectory: Of the trial, from its journal.
        progress: Of the trainee.
        bias: That all touches share.
    """
    findings = touch_findings(registration, normals, trajectory)
    return TrialFeedback(
        score=score,
        touches=findings,
        worst=max(findings, key=lambda finding: finding.residual_mm),
        advice=advise(score, findings, motion or {}, bias),
        progress=progress,
        paused_s=(motion or {}).get("pause_time_s", 0.0),
    )


def _accuracy_sentence(score: TrialScore) -> str:
    is_first = score.version == FIRST_SCORE_VERSION
    what = "expected at the target" if is_first else "true error in the brain"
    bias_mm, limit_mm = score.measures.common_bias_mm, score.reference.limit_mm
    bias = "" if bias_mm is None else f" and {fixed(bias_mm, 2)} mm common to all touches"
    beyond = []
    if not score.is_accurate:
        beyond.append(f"more than {limit_mm:g} mm of error")
    if score.is_unbiased is False:
        beyond.append(f"more than {COMMON_BIAS_LIMIT_MM:g} mm common to all touches")
    end = f"; {' and '.join(beyond)} is not acceptable." if beyond else "."
    return (
        f"Accuracy: {fixed(score.measures.tre_mm, 2)} mm {what}{bias}, worth "
        f"{fixed(100 * score.accuracy_desirability, 0)} of 100{end}"
    )


def _safety_sentence(measures: SafetyMeasures, desirability: float, is_safe: bool) -> str:
    beyond = (
        "."
        if is_safe
        else f"; more than {CONTACT_LIMIT_S:g} s, {CONTACT_PATH_LIMIT_MM:g} mm or "
        f"{DEPTH_LIMIT_MM:g} mm deep is not acceptable."
    )
    contact = ""
    if measures.contact_time_s > 0:
        contact = (
            f"{fixed(measures.contact_time_s, 1)} s and {fixed(measures.contact_path_mm, 0)} mm of "
            "unintended contact, "
        )
    return (
        f"Safety: {contact}pressed {fixed(measures.pressing_depth_mm, 1)} mm deep, worth "
        f"{fixed(100 * desirability, 0)} of 100{beyond}"
    )
