"""Storing, registering and scoring delivered trials, with feedback.

Slicer has what takes long done in a separate process, by the names of these functions: a trial's
journal holds thousands of lines, and a registration calls numpy hundreds of times. In a thread,
both would keep its window from answering. The study stays with Slicer.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from rastrainer.decision.drill_record import DrillRecord
from rastrainer.errors import InputError
from rastrainer.journal.recording import ReplayTrack, find_track, read_trajectory
from rastrainer.json_records import record_from_json
from rastrainer.protocol import TRIAL_RUN
from rastrainer.scenario.scenario import Scenario
from rastrainer.study.database.study import Study
from rastrainer.study.journal_check import check_journal
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import pass_mark_of
from rastrainer.trial.analysis import RevealedTruth, TrialAnalysis, analyze_trial
from rastrainer.trial.procedure_outcome import ProcedureOutcome, procedure_outcome
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import ScoreReference
from rastrainer.trial.touch_registration import GivenPoints, TouchRegistration, register_trial
from rastrainer.trial.trial_feedback import progress_of
from rastrainer.trial.trial_row import TrialRow
from rastrainer.work_progress import Progress


def store_delivered(
    value: Mapping[str, Any],
    study: Study,
    analyze: Callable[[TrialRecord], TrialAnalysis],
    is_being_scored: bool = False,
) -> tuple[TrialRecord | DrillRecord, TrialAnalysis | InputError | None]:
    """Store a trial with its registration, or a drill, once; `DeletedTrialError` if deleted.

    Return its record and its registration, or why it cannot be registered. A known trial is not
    registered again (None) if it was scored, or its score is being sent to the simulator.
    """
    if "cases" in value:
        drill = record_from_json(DrillRecord, value)
        study.add_drill(drill, value)
        return drill, None
    record = record_from_json(TrialRecord, value)
    is_new = study.is_new(record)
    if not is_new and (is_being_scored or study.is_revealed(record.trial_id)):
        return record, None
    try:
        analysis = analyze(record)
    except InputError as error:
        study.add_trial(record, delivered=value)
        return record, error
    study.add_trial(record, analysis.fits.values(), analysis.target_errors, delivered=value)
    return record, analysis


def score_references(study: Study) -> Mapping[str, ScoreReference] | None:
    protocol = StudyProgress(study).protocol()
    return None if protocol is None else protocol.references


def checks_journals(study: Study) -> bool:
    protocol = StudyProgress(study).protocol()
    return protocol is not None and protocol.check_journals


def scored_with_journal(
    analysis: TrialAnalysis,
    truth: RevealedTruth,
    scenario: Scenario,
    references: Mapping[str, ScoreReference] | None = None,
    records: Path | None = None,
    pause: Callable[[], None] = lambda: None,
) -> TrialAnalysis:
    """Score a registered trial, with the feedback of its journal.

    Without the folder of journals, less of the touches is explained. `pause` is called again and
    again while the journal is read; a thread may wait in it.
    """
    record = analysis.record
    trajectory = None if records is None else read_trajectory(records, record.trial_id, pause)
    return analysis.scored(scenario, truth, references, trajectory)


def with_progress(analysis: TrialAnalysis, study: Study) -> TrialAnalysis:
    """Return the analysis of a stored trial with the trainee's progress; trial runs have none."""
    record = analysis.record
    score = study.trial(record.trial_id).score
    if record.task == TRIAL_RUN or score is None:
        return analysis
    pass_mark = pass_mark_of(StudyProgress(study).protocol(), record.method)
    return with_progress_among(analysis, study.attempts(record.trainee), pass_mark)


def with_progress_among(
    analysis: TrialAnalysis, attempts: Sequence[TrialRow], pass_mark: float | None
) -> TrialAnalysis:
    """Return the analysis of a scored trial, with its place among these attempts, itself included.

    `pass_mark` is that for trials of its method; None without one.
    """
    progress = progress_of(attempts, analysis.record.trial_id, pass_mark)
    return replace(analysis, feedback=replace(analysis.feedback, progress=progress))


# Names for a separate process.
REGISTER = f"{__name__}:register"
REGISTER_OPEN = f"{__name__}:register_open"
SCORE = f"{__name__}:score"
EXPLAIN = f"{__name__}:explain"
EXPLAIN_PROCEDURE = f"{__name__}:explain_procedure"
READ_TRACK = f"{__name__}:read_track"
_READING = "Reading the journal"


def register(
    record: TrialRecord, scenario: Scenario, cohort: Sequence[TrialRow], progress: Progress
) -> TrialAnalysis:
    progress("Registering", 0.0)
    return analyze_trial(record, scenario, cohort)


def register_open(given: GivenPoints, scenario: Scenario, progress: Progress) -> TouchRegistration:
    progress("Registering", 0.0)
    return register_trial(given, scenario)


def score(
    analysis: TrialAnalysis,
    truth: RevealedTruth,
    scenario: Scenario,
    references: Mapping[str, ScoreReference] | None,
    records: Path | None,
    journal: bytes | None,
    progress: Progress,
) -> TrialAnalysis:
    """Return a registered trial with its score; arguments and errors of `scored_with_journal`.

    If its `journal` came with it, the trial must follow from that.
    """
    progress(_READING, 0.0)
    if journal is not None:
        check_journal(analysis.record, truth, journal, scenario)
    return scored_with_journal(analysis, truth, scenario, references, records)


def explain(
    record: TrialRecord, scenario: Scenario, records: Path, progress: Progress
) -> TrialAnalysis:
    progress(_READING, 0.0)
    return analyze_trial(record, scenario, trajectory=read_trajectory(records, record.trial_id))


def explain_procedure(
    record: TrialRecord, scenario: Scenario, truth: RevealedTruth, progress: Progress
) -> ProcedureOutcome | None:
    """Return the errors of a stored trial's procedure; None if it followed another plan."""
    progress("Computing errors", 0.0)
    try:
        return procedure_outcome(record, scenario, truth.matrix)
    except InputError as error:
        # The trial itself can be shown all the same.
        logging.info("The lines of a procedure are not shown: %s", error)
        return None


def read_track(records: Path, trial_id: str, progress: Progress) -> ReplayTrack:
    progress(_READING, 0.0)
    return find_track(records, trial_id)
