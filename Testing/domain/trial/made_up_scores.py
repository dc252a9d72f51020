"""Scores of trials that never were: gentle ones, with nothing but a time and an error."""

from dataclasses import replace

from rastrainer.trial.scoring import (
    FIRST_SCORE_VERSION,
    ScoreMeasures,
    ScoreReference,
    TrialScore,
    score_trial,
)

REFERENCE = ScoreReference(time_s=105.0, tre_mm=0.4)


def gentle_score(time_s: float, tre_mm: float, reference: ScoreReference = REFERENCE) -> TrialScore:
    """Return the score of a trial without unintended contact in which nothing was pressed."""
    return score_trial(ScoreMeasures(time_s, tre_mm, 0.0, 0.0, 0.0), reference)


def first_score(time_s: float, tre_mm: float) -> TrialScore:
    """Return a score as version 1 made them: of time and expected TRE alone."""
    return replace(
        gentle_score(time_s, tre_mm),
        safety_desirability=None,
        is_safe=None,
        measures=ScoreMeasures(time_s, tre_mm, None, None, None),
        version=FIRST_SCORE_VERSION,
    )
