"""The feedback on one trial, as data and as sentences for any view."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rastrainer.feedback.advice import Advice, advise
from rastrainer.feedback.progress_words import Standing
from rastrainer.feedback.touch_findings import TouchFinding, touch_findings
from rastrainer.feedback.wording import Sentence, say
from rastrainer.motion.trajectory import Trajectory
from rastrainer.number_text import fixed
from rastrainer.registration import Registration
from rastrainer.scoring import LONG_PAUSE_S, TrialScore

MOST_SHORT = 6
"""Sentences that fit beside the figures of a result at 1280 × 720."""


@dataclass(frozen=True)
class TrialFeedback:
    """What a trainee is told.

    Attributes:
        score: With its parts.
        touches: Every touch, in the order of touching.
        worst: The touch with the largest error; its `replay_s` is what to look at again.
        advice: Up to three things to improve, the first first.
        progress: None where there is no history.
        paused_s: How long the trial was paused in all, as far as that is known.
    """

    score: TrialScore
    touches: tuple[TouchFinding, ...]
    worst: TouchFinding
    advice: tuple[Advice, ...]
    progress: Standing | None
    paused_s: float = 0.0

    @property
    def score_sentences(self) -> tuple[str, ...]:
        """The score and what it is made of."""
        score = self.score
        pauses = (
            f"Paused for {fixed(self.paused_s, 0)} s in all, which the score leaves out: compare "
            "it with care to trials that were played in one go.",
        )
        return (
            f"Score {fixed(score.score, 0)} of 100.",
            f"Time: {fixed(score.completion_time_s, 0)} s, worth "
            f"{fixed(100 * score.time_desirability, 0)} of 100.",
            f"Accuracy: {fixed(score.expected_tre_mm, 2)} mm expected at the target, worth "
            f"{fixed(100 * score.accuracy_desirability, 0)} of 100"
            + (
                "."
                if score.acceptable
                else f"; more than {score.reference.limit_mm:g} mm is not acceptable."
            ),
            *(pauses if self.paused_s > LONG_PAUSE_S else ()),
        )

    @property
    def touch_sentences(self) -> tuple[Sentence, ...]:
        """The touches that hurt, the worst first; or that none stands out."""
        hurting = sorted((t for t in self.touches if t.hurts), key=lambda t: -t.residual_mm)
        if not hurting:
            return (say("no touch"),)
        return tuple(touch.sentence for touch in hurting)

    @property
    def sentences(self) -> tuple[str, ...]:
        """Everything, in the order in which it is told."""
        progress = () if self.progress is None else self.progress.sentences
        improve = tuple(f"{i}. {a.sentence}" for i, a in enumerate(self.advice, start=1))
        return (*self.score_sentences, *self.touch_sentences, *improve, *progress)

    @property
    def short_sentences(self) -> list[Sentence]:
        """What a page beside the score has room for: the worst touch, advice, and progress.

        The pass mark and the competence come last and are always among them.
        """
        progress = () if self.progress is None else self.progress.sentences
        others = [*self.touch_sentences[:1], *(a.sentence for a in self.advice)]
        return [*others, *progress[max(0, len(others) + len(progress) - MOST_SHORT) :]]


def trial_feedback(
    score: TrialScore,
    registration: Registration,
    normals: np.ndarray | None = None,
    motion: Mapping[str, float] | None = None,
    trajectory: Trajectory | None = None,
    progress: Standing | None = None,
) -> TrialFeedback:
    """Return the feedback on a trial; what is not known is left out.

    Args:
        score: Of the trial.
        registration: That was scored.
        normals: (n, 3) float, outward unit normals of the skin at the fiducials, RAS.
        motion: Motion metrics; those with `path_efficiency` tell of detours too.
        trajectory: Of the trial, from its journal.
        progress: Of the trainee.
    """
    findings = touch_findings(registration, normals, trajectory)
    return TrialFeedback(
        score=score,
        touches=findings,
        worst=max(findings, key=lambda finding: finding.residual_mm),
        advice=advise(score, findings, motion or {}),
        progress=progress,
        paused_s=(motion or {}).get("pause_time_s", 0.0),
    )
