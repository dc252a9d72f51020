"""Scores of trials that never were: gentle ones, with nothing but a time and an error."""

from rastrainer.scoring import ScoreMeasures, ScoreReference, TrialScore, score_trial

REFERENCE = ScoreReference(time_s=105.0, tre_mm=0.4)


def gentle_score(time_s: float, tre_mm: float, reference: ScoreReference = REFERENCE) -> TrialScore:
    """Return the score of a trial without unintended contact in which nothing was pressed."""
    return score_trial(ScoreMeasures(time_s, tre_mm, 0.0, 0.0, 0.0), reference)
