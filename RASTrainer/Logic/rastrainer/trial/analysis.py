"""Analysis of a trial's record: registrations, target errors, scores and submissions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.trial_head import UNMOVED, SkinShift
from rastrainer.json_checks import number, numbers
from rastrainer.motion.trajectory import Trajectory
from rastrainer.protocol import RegistrationMethod
from rastrainer.registration.fits import RIGID
from rastrainer.registration.target_error import CommonBias, common_bias, true_touch_errors
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial import ctps, touch_registration
from rastrainer.trial.advice import advise
from rastrainer.trial.procedure_outcome import ProcedureOutcome, procedure_outcome
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.score_reference import region_of, score_reference
from rastrainer.trial.scoring import ScoreMeasures, ScoreReference, TrialScore, score_trial
from rastrainer.trial.trial_feedback import TrialFeedback, trial_feedback
from rastrainer.trial.trial_row import TrialRow
from rastrainer.trial.wording import Sentence


@dataclass(frozen=True)
class RevealedTruth:
    """The true pose of the head, row by row, mm, MRI RAS to World, and how its skin has shifted.

    A study keeps no more of the shift than the record does.
    """

    head_to_world: Annotated[tuple[float, ...], numbers(16, 1e6)]
    true_tre_mm: Annotated[float, number(0, 1e6, "mm")]
    skin: SkinShift = UNMOVED

    @property
    def matrix(self) -> np.ndarray:
        """(4, 4) float, mm, from MRI RAS to World."""
        return np.reshape(self.head_to_world, (4, 4))


@dataclass(frozen=True)
class PublishedScore:
    """CTPS of a trial within a cohort, as in the paper's tables, and by its equation 3: half of it.

    `rastrainer.trial.ctps` describes its weaknesses.
    """

    published: float
    equation_3: float
    reference: ctps.CohortReference


@dataclass(frozen=True, kw_only=True)
class TrialAnalysis(touch_registration.TouchRegistration):
    """The results of one trial, with target errors at the scenario's target.

    The published score is the CTPS of the rigid registration; None without a cohort. Feedback is on
    this trial alone. The outcome of a procedure is None without the truth, or of touches alone.
    """

    record: TrialRecord
    target_name: str
    published_score: PublishedScore | None
    feedback: TrialFeedback
    truth: RevealedTruth | None = None
    score: TrialScore | None = None
    procedure: ProcedureOutcome | None = None

    def scored(
        self,
        scenario: Scenario,
        truth: RevealedTruth,
        references: Mapping[str, ScoreReference] | None = None,
        trajectory: Trajectory | None = None,
    ) -> TrialAnalysis:
        """Return the analysis with the truth and its score.

        The score uses the true error of the rigid registration and, of a trial by fiducials, the
        common bias of its touches. A landmark has no exact place, and a trace no bias. `references`
        of a study's protocol, by task, replace the scenario's.
        """
        record = self.record
        tre_mm = region_of(scenario).tre_mm(self.rigid.matrix, truth.matrix)
        bias = self._common_bias(scenario, truth)
        score = score_trial(
            ScoreMeasures.of(
                record.completion_time_s,
                tre_mm,
                None if bias is None else bias.length_mm,
                record.motion,
            ),
            score_reference(scenario, record.task, references, record.method),
            record.method,
        )
        unshifted = touch_registration.unshifted_tre_mm(record, scenario, truth.matrix, truth.skin)
        score = replace(score, unshifted_tre_mm=unshifted)
        normals = touch_registration.normals_at(
            scenario, record.task, self.rigid.labels, record.method
        )
        feedback = trial_feedback(self.rigid, normals, record.motion, trajectory)
        procedure = procedure_outcome(record, scenario, truth.matrix, references)
        explained = replace(self, feedback=feedback, procedure=procedure)
        return explained.scored_as(score, scenario, truth)

    def scored_as(
        self, score: TrialScore | None, scenario: Scenario, truth: RevealedTruth | None
    ) -> TrialAnalysis:
        bias = None if truth is None else self._common_bias(scenario, truth)
        advice = advise(score, self.feedback.touches, self.record.motion, bias)
        skin: tuple[Sentence, ...] = ()
        if truth is not None:
            unshifted = None if score is None else score.unshifted_tre_mm
            skin = touch_registration.skin_sentences(self.record.skin, truth.true_tre_mm, unshifted)
        return replace(
            self,
            truth=truth,
            score=score,
            feedback=replace(self.feedback, score=score, advice=advice, skin=skin),
        )

    def _common_bias(self, scenario: Scenario, truth: RevealedTruth) -> CommonBias | None:
        """Return the common bias of touched fiducials; None of a trial by another method."""
        rigid, record = self.rigid, self.record
        if record.method is not RegistrationMethod.FIDUCIALS:
            return None
        errors = true_touch_errors(rigid.moving_mm, truth.matrix, rigid.fixed_mm)
        normals = touch_registration.normals_at(scenario, record.task, rigid.labels, record.method)
        return common_bias(errors, normals)


def analyze_trial(
    record: TrialRecord,
    scenario: Scenario,
    cohort: Sequence[TrialRow] = (),
    trajectory: Trajectory | None = None,
    pause: Callable[[], None] = lambda: None,
) -> TrialAnalysis:
    """Register a trial by its method, its touches paired by label.

    CTPS compares with the trials of the cohort in the same mode. The trajectory explains why a
    touch was off. `pause` is called every 10 ms or so; a worker may wait in it.
    """
    registered = touch_registration.register_trial(
        touch_registration.GivenPoints.of_record(record), scenario, pause
    )
    rigid = registered.rigid
    normals = touch_registration.normals_at(scenario, record.task, rigid.labels, record.method)
    return TrialAnalysis(
        **vars(registered),
        record=record,
        target_name=scenario.target.name,
        published_score=(
            published_score(record, rigid.fre_mm, cohort)
            if record.method is RegistrationMethod.FIDUCIALS
            else None
        ),
        feedback=trial_feedback(rigid, normals, record.motion, trajectory),
    )


def published_score(
    record: TrialRecord, fre_mm: float, cohort: Sequence[TrialRow]
) -> PublishedScore | None:
    """Return the CTPS of a trial with this FRE, or None without a reference."""
    try:
        reference = ctps.CohortReference.of([t for t in cohort if t.mode == record.mode])
    except InputError:
        return None
    published = ctps.published_ctps(record.completion_time_s, fre_mm, reference)
    return PublishedScore(published, published / 2, reference)


def score_arguments(analysis: TrialAnalysis) -> dict[str, Any]:
    score, progress = analysis.score, analysis.feedback.progress
    procedure = {} if analysis.procedure is None else {"procedure": analysis.procedure.summary()}
    # An analysis with the truth has a score.
    assert score is not None
    published, measures = analysis.published_score, score.measures
    # A trial run has no progress, and no mark; null is a study's without a mark for this method.
    mark = {} if progress is None else {"passMark": progress.pass_mark}
    return {
        "trialId": analysis.record.trial_id,
        "score": score.score,
        "details": {
            "scoreVersion": score.version,
            "residualsMm": analysis.rigid.residuals_mm.tolist(),
            "treIntervalMm": list(analysis.target_errors[RIGID].interval_mm),
            "regionTreMm": measures.tre_mm,
            "regionLimitMm": score.reference.limit_mm,
            "commonBiasMm": measures.common_bias_mm,
            "contactTimeS": measures.contact_time_s,
            "contactPathMm": measures.contact_path_mm,
            "pressingDepthMm": measures.pressing_depth_mm,
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
