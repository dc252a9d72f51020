"""From a trial's record to its numbers: registrations, target errors, scores."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from rastrainer import ctps
from rastrainer.brain_region import region_of
from rastrainer.errors import InputError
from rastrainer.feedback.advice import advise
from rastrainer.feedback.trial_feedback import TrialFeedback, trial_feedback
from rastrainer.fiducial_normals import fiducial_normals
from rastrainer.localization_error import error_along_surface
from rastrainer.motion.trajectory import Trajectory
from rastrainer.point_list import PointList, pair
from rastrainer.registration import AFFINE, RIGID, SIMILARITY, Registration, register
from rastrainer.revealed_truth import RevealedTruth
from rastrainer.scenario import Scenario
from rastrainer.score_reference import score_reference
from rastrainer.scoring import ScoreMeasures, ScoreReference, TrialScore, score_trial
from rastrainer.target_error import TargetError, target_error
from rastrainer.trial_record import TrialRecord


@dataclass(frozen=True)
class PublishedScore:
    """CTPS of a trial against a cohort; see `rastrainer.ctps` for what speaks against it.

    Attributes:
        published: 100·(CT score − RMSE penalty), from which the paper's tables follow.
        equation_3: the paper's equation 3 as printed: half of it.
        reference: what the cohort gave to compare with.
    """

    published: float
    equation_3: float
    reference: ctps.CohortReference


@dataclass(frozen=True)
class TrialAnalysis:
    """The numbers of one trial.

    Attributes:
        record: the trial.
        target_name: of the scenario's target, at which the target errors are told.
        fits: the registration of each kind that the points allow; rigid is always there.
        target_errors: by kind, the error to expect at the target.
        truth: what the simulator has revealed; None before.
        score: ours, of the rigid registration; None without the truth.
        published_score: CTPS of the rigid registration; None where no cohort was given.
        feedback: what the trainee is told of this trial alone.
    """

    record: TrialRecord
    target_name: str
    fits: Mapping[str, Registration]
    target_errors: Mapping[str, TargetError]
    truth: RevealedTruth | None
    score: TrialScore | None
    published_score: PublishedScore | None
    feedback: TrialFeedback

    @property
    def rigid(self) -> Registration:
        """The registration that is scored."""
        return self.fits[RIGID]

    @property
    def expected_tre(self) -> TargetError:
        """The error to expect at the target with the registration that is scored."""
        return self.target_errors[RIGID]

    def scored_as(self, score: TrialScore | None) -> TrialAnalysis:
        """Return the analysis with the score that was once made of the trial, in its version."""
        advice = advise(score, self.feedback.touches, self.record.motion)
        return replace(
            self, score=score, feedback=replace(self.feedback, score=score, advice=advice)
        )


def analyze_trial(
    record: TrialRecord,
    scenario: Scenario,
    cohort: Sequence[ctps.Trial] = (),
    references: Mapping[str, ScoreReference] | None = None,
    trajectory: Trajectory | None = None,
    truth: RevealedTruth | None = None,
) -> TrialAnalysis:
    """Register a trial's touches to its task's fiducials, paired by label, and score it.

    The score is made of the true error of the rigid registration of all touches.

    Args:
        record: the trial.
        scenario: in which it was played.
        cohort: trials that CTPS compares with; those of the trial's own mode count.
        references: of the score, by task, as a study's protocol sets them; those of the scenario
            for tasks that it leaves out.
        trajectory: of the trial, from its journal; it tells why a touch was off.
        truth: what the simulator has revealed; without it there is no score.

    Raises:
        InputError: the scenario has no such task or labels, or the points cannot be registered, or
            the trial's contacts were not measured.
    """
    task = scenario.task(record.task)
    labels, moving, fixed = pair(
        PointList(record.labels, record.positions_mm), PointList(task.labels, task.fiducials)
    )
    fits = {RIGID: register(moving, fixed, RIGID, labels)}
    for kind in (SIMILARITY, AFFINE):
        # Points in one plane allow no affine fit; it is only looked at anyway.
        with contextlib.suppress(InputError):
            fits[kind] = register(moving, fixed, kind, labels)
    rows = [task.labels.index(label) for label in labels]
    normals = fiducial_normals(scenario, record.task)[rows]
    errors = {
        kind: target_error(fit, scenario.target_position, error_along_surface(fit, normals))
        for kind, fit in fits.items()
    }
    score = None
    if truth is not None:
        tre_mm = region_of(scenario).tre_mm(fits[RIGID].matrix, truth.matrix)
        score = score_trial(
            ScoreMeasures.of(record.completion_time_s, tre_mm, record.motion),
            score_reference(scenario, record.task, references),
        )
    return TrialAnalysis(
        record=record,
        target_name=scenario.target_name,
        fits=fits,
        target_errors=errors,
        truth=truth,
        score=score,
        published_score=published_score(record, fits[RIGID].fre_mm, cohort),
        feedback=trial_feedback(score, fits[RIGID], normals, record.motion, trajectory),
    )


def published_score(
    record: TrialRecord, fre_mm: float, cohort: Sequence[ctps.Trial]
) -> PublishedScore | None:
    """Return the CTPS of a trial with this FRE; None where its mode has no peers to divide by."""
    try:
        reference = ctps.CohortReference.of([t for t in cohort if t.mode == record.mode])
    except InputError:
        return None
    time = record.completion_time_s
    return PublishedScore(
        ctps.published_ctps(time, fre_mm, reference),
        ctps.equation_3_ctps(time, fre_mm, reference),
        reference,
    )
