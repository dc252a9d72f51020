"""The errors and the score of a trial's procedure, once the truth is revealed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.procedure.errors import ProcedureAnalysis, TrajectoryErrors, analyze_procedure
from rastrainer.procedure.plan import read_procedure_meshes
from rastrainer.procedure.score import (
    ProcedureMeasures,
    ProcedureScore,
    reference_duration_s,
    score_procedure,
)
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.score_reference import score_reference
from rastrainer.trial.scoring import ScoreReference


@dataclass(frozen=True, eq=False)
class ProcedureOutcome:
    """What became of a procedure.

    Attributes:
        analysis: its errors.
        score: from them.
    """

    analysis: ProcedureAnalysis
    score: ProcedureScore

    def summary(self) -> dict[str, Any]:
        """Return the feedback for the trainee, ready for JSON: few numbers for each trajectory."""
        analysis, score = self.analysis, self.score
        return {
            "score": score.score,
            "scoreVersion": score.version,
            "acceptable": score.acceptable,
            "isAccurate": score.is_accurate,
            "isSafe": score.is_safe,
            "desirabilities": dict(score.desirabilities),
            "targetRmsMm": analysis.target_rms_mm,
            "targetByRegistrationRmsMm": analysis.target_by_registration_rms_mm,
            "targetByHandRmsMm": analysis.target_by_hand_rms_mm,
            "entryRmsMm": analysis.entry_rms_mm,
            "angleRmsDeg": analysis.angle_rms_deg,
            "hits": [list(hit) for hit in analysis.hits],
            "trajectories": [_summary(each) for each in analysis.trajectories],
        }


def procedure_outcome(
    record: TrialRecord,
    scenario: Scenario,
    head_to_world: np.ndarray,
    references: Mapping[str, ScoreReference] | None = None,
) -> ProcedureOutcome | None:
    """Return the errors and the score of a trial's procedure; None for touches alone.

    Args:
        record: the trial.
        scenario: in which it was carried out.
        head_to_world: (4, 4) float, mm, the true pose.
        references: of the score of touches, by task, as a study's protocol sets them.

    Raises:
        InputError: the scenario has no such procedure or another plan, or a mesh is unusable.
    """
    done = record.procedure
    if done is None:
        return None
    procedure = scenario.procedure(done.procedure)
    skull = scenario.skull_mesh
    assert skull is not None, "a scenario with procedures has a skull"
    meshes = read_procedure_meshes(procedure, skull)
    if done.sha256 != procedure.sha256(skull):
        raise InputError(
            "The trial was carried out with a different plan from the procedure "
            f"{procedure.name!r} of the scenario {scenario.name} here."
        )
    analysis = analyze_procedure(done, procedure, meshes, head_to_world)
    touching = score_reference(scenario, record.task, references, record.method).time_s
    reference_s = reference_duration_s(touching, procedure)
    score = score_procedure(ProcedureMeasures.of(analysis), reference_s)
    return ProcedureOutcome(analysis, score)


def _summary(errors: TrajectoryErrors) -> dict[str, Any]:
    nearest = min(errors.kept_mm, key=errors.kept_mm.__getitem__, default=None)
    depth, depth_by_registration, depth_by_hand = errors.depth
    return {
        "name": errors.trajectory.name,
        "targetMm": errors.target.length_mm,
        "byRegistrationMm": errors.target.registration_mm,
        "byHandMm": errors.target.hand_mm,
        "entryMm": errors.entry.length_mm,
        "entryByRegistrationMm": errors.entry.registration_mm,
        "entryByHandMm": errors.entry.hand_mm,
        "radialMm": errors.radial.length_mm,
        "radialByRegistrationMm": errors.radial.registration_mm,
        "radialByHandMm": errors.radial.hand_mm,
        "depthMm": depth,
        "depthByRegistrationMm": depth_by_registration,
        "depthByHandMm": depth_by_hand,
        "angleDeg": errors.angle_deg,
        "angleByRegistrationDeg": errors.registration_angle_deg,
        "angleByHandDeg": errors.hand_angle_deg,
        "plungeMm": errors.plunge_mm,
        "nearest": nearest,
        "keptMm": None if nearest is None else errors.kept_mm[nearest],
    }
