"""What can be told of a trial when its study and its journal are at hand: analysis and feedback."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rastrainer.ctps import Trial
from rastrainer.experiment.study_progress import StudyProgress
from rastrainer.experiment.study_protocol import pass_mark_of
from rastrainer.feedback.progress_words import progress_of
from rastrainer.journal.folder import read_trajectory
from rastrainer.protocol import TRIAL_RUN
from rastrainer.revealed_truth import RevealedTruth
from rastrainer.scenario import Scenario
from rastrainer.study import Study
from rastrainer.study_aborted import AbortedTrials
from rastrainer.trial_analysis import TrialAnalysis, analyze_trial
from rastrainer.trial_record import TrialRecord


def review(
    record: TrialRecord,
    scenario: Scenario,
    study: Study,
    records: Path | None = None,
    cohort: Sequence[Trial] = (),
    truth: RevealedTruth | None = None,
) -> TrialAnalysis:
    """Analyze a trial as its study's protocol says, with the feedback that its journal allows.

    Args:
        record: the trial.
        scenario: in which it was played.
        study: whose protocol sets the references of the score.
        records: folder of journals; None, or one that is not there, tells less about the touches.
        cohort: trials that CTPS compares with.
        truth: what the simulator has revealed; without it there is no score.

    Raises:
        InputError: the trial cannot be registered, or the study not be read.
    """
    protocol = StudyProgress(study).protocol()
    references = None if protocol is None else protocol.references
    here = records is not None and records.is_dir()
    trajectory = read_trajectory(records, record.trial_id) if here else None
    return analyze_trial(record, scenario, cohort, references, trajectory, truth)


def with_progress(analysis: TrialAnalysis, study: Study) -> TrialAnalysis:
    """Return the analysis of a stored trial, told how it stands among the trainee's own ones.

    A trial run is for getting to know everything: it passes nothing.

    Raises:
        InputError: the study has no such trial.
    """
    record = analysis.record
    if record.task == TRIAL_RUN or study.trial(record.trial_id).score is None:
        return analysis
    pass_mark = pass_mark_of(StudyProgress(study).protocol())
    progress = progress_of(
        AbortedTrials(study).attempts(record.trainee), record.trial_id, pass_mark
    )
    return replace(analysis, feedback=replace(analysis.feedback, progress=progress))
