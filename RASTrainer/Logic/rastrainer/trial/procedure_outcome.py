"""The outcome of a trial's procedure: its true errors, and a score of 0 to 100.

Errors, drilling, distances kept and time have strictly decreasing desirabilities, as in
`rastrainer.trial.scoring`, and the score is 100 times the geometric mean of all. Beyond a limit, or
if it hits a no-go structure or misses bone, a procedure is not acceptable and scores below every
acceptable procedure: speed cannot make up for it.
Checkpoints, FRE and expected TRE play no part: none of them sees an offset common to all touches.

The values of half and limit are our own convention, near published figures: clinical target point
errors of 1.91 mm (DBS) and 2.34 mm (SEEG; 10.1093/neuros/nyaa428), and a median entry point error
of 1.54 mm (SEEG; 10.1007/s00701-017-3242-9).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.json_checks import number, whole_number
from rastrainer.procedure.errors import ProcedureAnalysis, TrajectoryErrors, analyze_procedure
from rastrainer.procedure.plan import MAX_SAFETY_MM, Procedure, read_procedure_meshes
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial import scoring
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.score_reference import score_reference

PROCEDURE_SCORE_VERSION = "procedure-1"
"""Changes with any change of a formula or a reference, so that scores stay comparable."""
HALF_TARGET_MM, TARGET_LIMIT_MM = 2.0, 3.0
HALF_ENTRY_MM, ENTRY_LIMIT_MM = 1.5, 3.0
HALF_ANGLE_DEG, ANGLE_LIMIT_DEG = 2.0, 5.0
HALF_PLUNGE_MM, PLUNGE_LIMIT_MM = 2.0, 5.0
HALF_INTRUSION_MM = 1.5
_Measure = Annotated[float, number(0, scoring.MAX_MEASURE)]
_Count = Annotated[int, whole_number(0, 10_000)]

VERIFYING_S, ALIGNING_S, DRILLING_S, HANDLING_S = 15.0, 45.0, 15.0, 10.0
"""Times of the reference: once, and three for each trajectory. Our own convention."""
SELF_ALIGNING_S = 15.0
"""In place of the time for aligning, where the robot aligned the guide."""
STAND_OFF_MM, INSERTION_MM_S = 30.0, 8.0
"""Distance that the instrument travels before its entry, and its speed, in the reference."""


@dataclass(frozen=True)
class ProcedureMeasures:
    """The measures of a procedure that its score is computed from.

    Attributes:
        duration_s: from the start of the trial to the last release, without pauses; above 0.
        target_mm, entry_mm, angle_deg: root mean squares of the true errors; each with the largest
            error.
        plunge_mm: the deepest that the drill was past an inner table.
        intrusion_mm: how far an instrument is within its safety distance to a no-go structure.
        hits, missed_bone: how many instruments meet a no-go structure, and miss the skull.
    """

    duration_s: _Measure
    target_mm: _Measure
    worst_target_mm: _Measure
    entry_mm: _Measure
    worst_entry_mm: _Measure
    angle_deg: _Measure
    worst_angle_deg: _Measure
    plunge_mm: _Measure
    intrusion_mm: _Measure
    hits: _Count
    missed_bone: _Count

    @classmethod
    def of(cls, analysis: ProcedureAnalysis, procedure: Procedure) -> ProcedureMeasures:
        each = analysis.trajectories
        intrusions = [
            max(0.0, plan.safety_mm - min(errors.kept_mm.values(), default=math.inf))
            for plan, errors in zip(procedure.trajectories, each, strict=True)
        ]
        return cls(
            duration_s=analysis.duration_s,
            target_mm=analysis.target_point_error_rms_mm,
            worst_target_mm=max(one.target_point_error.mm for one in each),
            entry_mm=analysis.entry_point_error_rms_mm,
            worst_entry_mm=max(one.entry_point_error.mm for one in each),
            angle_deg=analysis.angular_deviation_rms_deg,
            worst_angle_deg=max(one.angular_deviation_deg for one in each),
            plunge_mm=max(one.plunge_mm or 0.0 for one in each),
            intrusion_mm=max(intrusions),
            hits=len(analysis.hits),
            missed_bone=len(analysis.missed_bone),
        )

    @property
    def is_accurate(self) -> bool:
        """Whether every error is within its limit, and every instrument in the skull."""
        return (
            self.worst_target_mm <= TARGET_LIMIT_MM
            and self.worst_entry_mm <= ENTRY_LIMIT_MM
            and self.worst_angle_deg <= ANGLE_LIMIT_DEG
            and self.missed_bone == 0
        )

    @property
    def is_safe(self) -> bool:
        """Whether no no-go structure is hit, and the drill stopped in time."""
        return self.hits == 0 and self.plunge_mm <= PLUNGE_LIMIT_MM


@dataclass(frozen=True)
class ProcedureScore:
    """The score of a procedure and its parts, by measure: `time`, `target`, `entry`, …

    `reference_s` is the duration of half the range of the time desirability.
    """

    score: Annotated[float, number(0, 100)]
    desirabilities: Mapping[str, scoring.Desirability]
    is_accurate: bool
    is_safe: bool
    measures: ProcedureMeasures
    reference_s: _Measure
    version: str = PROCEDURE_SCORE_VERSION

    @property
    def acceptable(self) -> bool:
        return self.is_accurate and self.is_safe


def reference_duration_s(touching_s: float, procedure: Procedure, self_aligned: int = 0) -> float:
    """Return the reference duration of a procedure, after the touches of the trial's task.

    It takes less time where the robot aligned the guide: on `self_aligned` trajectories.
    """
    inserting = sum(
        (STAND_OFF_MM + trajectory.length_mm) / INSERTION_MM_S
        for trajectory in procedure.trajectories
    )
    each = ALIGNING_S + DRILLING_S + HANDLING_S
    saved = self_aligned * (ALIGNING_S - SELF_ALIGNING_S)
    return touching_s + VERIFYING_S + each * len(procedure.trajectories) + inserting - saved


def score_procedure(measures: ProcedureMeasures, reference_s: float) -> ProcedureScore:
    scoring.check_measures(measures, "The procedure's measures")
    if measures.duration_s == 0:
        raise InputError("The procedure's duration must be above 0 s.")
    desirabilities = {
        "time": scoring.of_time(measures.duration_s, reference_s),
        **_besides_time(
            *(measures.target_mm, measures.entry_mm, measures.angle_deg),
            *(measures.plunge_mm, measures.intrusion_mm),
        ),
    }
    product = math.prod(desirabilities.values())
    if not (measures.is_accurate and measures.is_safe):
        product *= WORST_ACCEPTABLE
    return ProcedureScore(
        score=100 * product ** (1 / len(desirabilities)),
        desirabilities=desirabilities,
        is_accurate=measures.is_accurate,
        is_safe=measures.is_safe,
        measures=measures,
        reference_s=reference_s,
    )


def _besides_time(
    target_mm: float, entry_mm: float, angle_deg: float, plunge_mm: float, intrusion_mm: float
) -> dict[str, float]:
    return {
        "target": scoring.falling(target_mm, HALF_TARGET_MM),
        "entry": scoring.falling(entry_mm, HALF_ENTRY_MM),
        "angle": scoring.falling(angle_deg, HALF_ANGLE_DEG),
        "plunge": scoring.falling(plunge_mm, HALF_PLUNGE_MM),
        "distance": scoring.falling(intrusion_mm, HALF_INTRUSION_MM),
    }


_AT_LIMITS = _besides_time(
    TARGET_LIMIT_MM, ENTRY_LIMIT_MM, ANGLE_LIMIT_DEG, PLUNGE_LIMIT_MM, MAX_SAFETY_MM
)
WORST_ACCEPTABLE = scoring.TIME_FLOOR * math.prod(_AT_LIMITS.values())
"""Brings, as a factor, every procedure beyond a limit below every acceptable one.

It is the product of the desirabilities at all limits and infinite time.
"""


@dataclass(frozen=True)
class ProcedureOutcome:
    """The errors of a procedure, and its score from them."""

    analysis: ProcedureAnalysis
    score: ProcedureScore

    def summary(self) -> dict[str, Any]:
        analysis, score = self.analysis, self.score
        return {
            "score": score.score,
            "scoreVersion": score.version,
            "acceptable": score.acceptable,
            "isAccurate": score.is_accurate,
            "isSafe": score.is_safe,
            "desirabilities": dict(score.desirabilities),
            "targetRmsMm": analysis.target_point_error_rms_mm,
            "targetByRegistrationRmsMm": analysis.target_point_error_by_registration_rms_mm,
            "targetByHandRmsMm": analysis.target_point_error_by_hand_rms_mm,
            "entryRmsMm": analysis.entry_point_error_rms_mm,
            "angleRmsDeg": analysis.angular_deviation_rms_deg,
            "hits": [list(hit) for hit in analysis.hits],
            "trajectories": [_summary(each) for each in analysis.trajectories],
        }


def procedure_outcome(
    record: TrialRecord,
    scenario: Scenario,
    head_to_world: np.ndarray,
    references: Mapping[str, scoring.ScoreReference] | None = None,
) -> ProcedureOutcome | None:
    """Return the errors and the score of a trial's procedure; None for touches alone.

    The true pose is (4, 4) float, mm. The references of the score of touches are by task, as a
    study's protocol sets them.
    """
    done = record.procedure
    if done is None:
        return None
    procedure = scenario.procedure(done.procedure)
    skull = scenario.skull_path
    meshes = read_procedure_meshes(procedure, skull)
    if done.sha256 != procedure.sha256(skull):
        raise InputError(
            "The trial was carried out with a different plan from the procedure "
            f"{procedure.name!r} of the scenario {scenario.name} here."
        )
    analysis = analyze_procedure(done, procedure, meshes, head_to_world)
    touching = score_reference(scenario, record.task, references, record.method).time_s
    reference_s = reference_duration_s(touching, procedure, analysis.self_aligned)
    score = score_procedure(ProcedureMeasures.of(analysis, procedure), reference_s)
    return ProcedureOutcome(analysis, score)


def _summary(errors: TrajectoryErrors) -> dict[str, Any]:
    nearest = min(errors.kept_mm, key=errors.kept_mm.__getitem__, default=None)
    target, entry = errors.target_point_error, errors.entry_point_error
    return {
        "name": errors.trajectory,
        "selfAligned": errors.self_aligned,
        "targetMm": target.mm,
        "byRegistrationMm": target.by_registration_mm,
        "byHandMm": target.by_hand_mm,
        "entryMm": entry.mm,
        "entryByRegistrationMm": entry.by_registration_mm,
        "entryByHandMm": entry.by_hand_mm,
        "radialMm": errors.radial_error.mm,
        "radialByRegistrationMm": errors.radial_error.by_registration_mm,
        "radialByHandMm": errors.radial_error.by_hand_mm,
        "depthMm": errors.depth_error_mm,
        "depthByRegistrationMm": errors.depth_error_by_registration_mm,
        "depthByHandMm": errors.depth_error_by_hand_mm,
        "angleDeg": errors.angular_deviation_deg,
        "angleByRegistrationDeg": errors.angular_deviation_by_registration_deg,
        "angleByHandDeg": errors.angular_deviation_by_hand_deg,
        "plungeMm": errors.plunge_mm,
        "nearest": nearest,
        "keptMm": None if nearest is None else errors.kept_mm[nearest],
    }
