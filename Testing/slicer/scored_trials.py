"""Trials with a score, as they are once the simulator has revealed where the head was."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from rastrainer import transforms
from rastrainer.scenario.scenario import Scenario, load_scenario
from rastrainer.study.database.study import Study
from rastrainer.trial.analysis import RevealedTruth, TrialAnalysis, analyze_trial
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import SAFETY_METRICS
from rastrainer_simulator.assets import asset_path
from Testing.slicer.host.host import Host


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


def store_trial_on_colin(host: Host, record: dict[str, Any], seed: int) -> np.ndarray:
    """Store a scored trial of Task 1 on Colin27 in the module's study.

    Args:
        host: with the module open.
        record: of such a trial; its points become touches near the fiducials.
        seed: of the head's pose and of the touches.

    Returns:
        The touches, (15, 3) float, World, mm.
    """
    colin = load_scenario(asset_path("scenarios", "colin27"))
    noise = np.random.default_rng(seed).normal(0.0, 0.6, (15, 3))
    fiducials = colin.task("task-1").fiducials
    touched = transforms.apply(colin.perturbed_head_to_world(seed), fiducials + noise)
    for point, position in zip(record["points"], touched.tolist(), strict=True):
        point["positionMm"] = position
    analysis = scored_analysis(record, colin)
    with Study.open(host.find("studyPathLineEdit").currentPath) as study:
        study.add_trial(record, analysis.fits.values(), analysis.target_errors, analysis.score)
    return touched
