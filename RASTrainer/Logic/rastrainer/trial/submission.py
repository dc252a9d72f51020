"""What is submitted of a registered and scored trial: the arguments of the two commands.

Slicer sends them over OpenIGTLink; a simulator that no Slicer is connected to gives them to itself.
"""

from __future__ import annotations

from typing import Any

from rastrainer.trial.analysis import TrialAnalysis
from rastrainer.trial.touch_registration import TouchRegistration


def registration_arguments(analysis: TrialAnalysis) -> dict[str, Any]:
    """Return the arguments of SubmitRegistration, ready for JSON."""
    registered = TouchRegistration(analysis.fits, analysis.target_errors)
    return registered.arguments(analysis.record.trial_id)


def score_arguments(analysis: TrialAnalysis) -> dict[str, Any]:
    """Return the arguments of TrialScored for a trial with truth and score, ready for JSON."""
    score, progress = analysis.score, analysis.feedback.progress
    procedure = {} if analysis.procedure is None else {"procedure": analysis.procedure.summary()}
    # What was analyzed with its truth has a score.
    assert score is not None
    published = analysis.published_score
    # A trial run has no progress, and no mark; null is a study's without a mark for this version.
    mark = {} if progress is None else {"passMark": progress.pass_mark}
    return {
        "trialId": analysis.record.trial_id,
        "score": score.score,
        "details": {
            "scoreVersion": score.version,
            "residualsMm": analysis.rigid.residuals_mm.tolist(),
            "treIntervalMm": list(analysis.expected_tre.interval_mm),
            "regionTreMm": score.measures.tre_mm,
            "commonBiasMm": score.measures.common_bias_mm,
            "timeDesirability": score.time_desirability,
            "accuracyDesirability": score.accuracy_desirability,
            "safetyDesirability": score.safety_desirability,
            "isAccurate": score.is_accurate,
            "isUnbiased": score.is_unbiased,
            "isSafe": score.is_safe,
            "ctps": None if published is None else published.published,
            "warnings": [warning.message for warning in analysis.rigid.warnings],
            **mark,
            "feedback": [each.to_json() for each in analysis.feedback.short_sentences],
            **procedure,
        },
    }
