"""The numbers of a trial as JSON, for files and for programs that read them."""

from __future__ import annotations

from typing import Any

from rastrainer.ctps import CTPS_WARNING
from rastrainer.registration import Registration
from rastrainer.target_error import TargetError
from rastrainer.trial_analysis import PublishedScore, TrialAnalysis


def results_json(analysis: TrialAnalysis) -> dict[str, Any]:
    """Return the numbers of a trial as a JSON object; lengths in mm, times in s."""
    record = analysis.record
    return {
        "trial_id": record.trial_id,
        "trainee": record.trainee,
        "task": record.task,
        "mode": record.mode,
        "scenario": record.scenario,
        "completion_time_s": record.completion_time_s,
        "rejected_touches": record.rejected_touches,
        "undone_touches": record.undone_touches,
        "labels": list(record.labels),
        "fits": {
            kind: _fit_json(fit, analysis.target_errors[kind])
            for kind, fit in analysis.fits.items()
        },
        "target": {
            "name": analysis.target_name,
            "position_ras_mm": list(analysis.expected_tre.target_mm),
        },
        "truth": None if analysis.truth is None else _truth_json(analysis),
        "score": None if analysis.score is None else analysis.score.to_json(),
        "feedback": list(analysis.feedback.sentences),
        "motion": dict(record.motion),
        "ctps": None if analysis.published_score is None else _ctps_json(analysis.published_score),
    }


def _fit_json(fit: Registration, error: TargetError) -> dict[str, Any]:
    return {
        "type": fit.kind,
        "fre_mm": fit.fre_mm,
        "matrix": fit.matrix.tolist(),
        "residuals_mm": fit.residuals_mm.tolist(),
        "expected_tre_mm": error.expected_mm,
        "tre_interval_mm": list(error.interval_mm),
        "confidence": error.confidence,
        "warnings": [warning.to_json() for warning in fit.warnings],
    }


def _truth_json(analysis: TrialAnalysis) -> dict[str, Any]:
    truth, (low, high) = analysis.truth, analysis.expected_tre.interval_mm
    return {
        "head_to_world": truth.matrix.tolist(),
        "true_tre_mm": truth.true_tre_mm,
        "within_interval": low <= truth.true_tre_mm <= high,
    }


def _ctps_json(score: PublishedScore) -> dict[str, Any]:
    return {
        "published": score.published,
        "equation_3": score.equation_3,
        "mean_ct_s": score.reference.mean_ct_s,
        "best_rmse_mm": score.reference.best_rmse_mm,
        "warning": CTPS_WARNING,
    }
