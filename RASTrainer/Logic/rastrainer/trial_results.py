"""The numbers of a trial as JSON, for files and for programs that read them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer import protocol
from rastrainer.ctps import CTPS_WARNING
from rastrainer.errors import InputError
from rastrainer.registration import Registration
from rastrainer.target_error import TargetError
from rastrainer.trial_analysis import PublishedScore, TrialAnalysis


@dataclass(frozen=True)
class RevealedTruth:
    """What the simulator tells once a trial is scored.

    Attributes:
        head_to_world: 16 numbers, row by row, mm: where the head was, from MRI RAS to World.
        true_tre_mm: how far the registration put the target from where it is.
    """

    head_to_world: tuple[float, ...]
    true_tre_mm: float

    @classmethod
    def from_json(cls, answer: Mapping[str, Any]) -> RevealedTruth:
        """Return what the answer to TrialScored or GetTrial reveals.

        Raises:
            InputError: it reveals nothing, or not numbers.
        """
        try:
            return cls(
                protocol.numbers(16, 1e6)(answer.get("headToWorld")),
                protocol.number(0, 1e6)(answer.get("trueTreMm")),
            )
        except ValueError:
            raise InputError(
                "The simulator's answer must hold headToWorld, 16 numbers, and trueTreMm."
            ) from None


def results_json(analysis: TrialAnalysis, truth: RevealedTruth | None = None) -> dict[str, Any]:
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
        "truth": None if truth is None else _truth_json(truth, analysis.expected_tre),
        "score": analysis.score.to_json(),
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


def _truth_json(truth: RevealedTruth, expected: TargetError) -> dict[str, Any]:
    low, high = expected.interval_mm
    return {
        "head_to_world": np.reshape(truth.head_to_world, (4, 4)).tolist(),
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
