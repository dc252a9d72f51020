"""Trials with a score, as they are once the simulator has revealed where the head was."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rastrainer.revealed_truth import RevealedTruth
from rastrainer.scenario import Scenario
from rastrainer.scoring import SAFETY_METRICS
from rastrainer.trial_analysis import TrialAnalysis, analyze_trial
from rastrainer.trial_record import TrialRecord


def scored_analysis(
    record: Mapping[str, Any], scenario: Scenario, seed: int = 1, true_tre_mm: float = 0.3
) -> TrialAnalysis:
    """Return the analysis of a gentle trial whose head stood where the seed has it.

    Whatever the record says of other motion is kept.
    """
    motion = dict.fromkeys(SAFETY_METRICS, 0.0) | dict(record.get("motion", {}))
    pose = scenario.perturbed_head_to_world(seed)
    truth = RevealedTruth(tuple(pose.ravel().tolist()), true_tre_mm)
    return analyze_trial(TrialRecord.from_json({**record, "motion": motion}), scenario, truth=truth)
