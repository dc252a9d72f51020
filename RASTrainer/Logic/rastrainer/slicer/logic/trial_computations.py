"""What is computed for a trial in a separate process: registration, score, feedback, its replay.

A trial's journal holds thousands of lines, and a registration calls numpy hundreds of times. In a
thread of Slicer's, both would keep its window from answering. The study stays with Slicer.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.journal.recording import ReplayTrack, find_track
from rastrainer.scenario.scenario import Scenario
from rastrainer.study.delivered_trial import scored_with_journal, trajectory_of
from rastrainer.trial import ctps
from rastrainer.trial.analysis import RevealedTruth, TrialAnalysis, analyze_trial
from rastrainer.trial.procedure_outcome import ProcedureOutcome, procedure_outcome
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import ScoreReference
from rastrainer.trial.touch_registration import GivenPoints, TouchRegistration, register_trial
from rastrainer.work_progress import Progress

REGISTER = f"{__name__}:register"
REGISTER_OPEN = f"{__name__}:registerOpen"
SCORE = f"{__name__}:score"
EXPLAIN = f"{__name__}:explain"
EXPLAIN_PROCEDURE = f"{__name__}:explainProcedure"
READ_TRACK = f"{__name__}:readTrack"
_READING = "Reading the journal"


def register(
    record: TrialRecord, scenario: Scenario, cohort: Sequence[ctps.Trial], progress: Progress
) -> TrialAnalysis:
    """Return the registration of a trial; its journal, which takes long to read, is not needed.

    Raises:
        InputError: it cannot be registered.
    """
    progress("Registering", 0.0)
    return analyze_trial(record, scenario, cohort)


def registerOpen(given: GivenPoints, scenario: Scenario, progress: Progress) -> TouchRegistration:
    """Return the registration of an open trial; errors of `register_trial`."""
    progress("Registering", 0.0)
    return register_trial(given, scenario)


def score(
    analysis: TrialAnalysis,
    truth: RevealedTruth,
    scenario: Scenario,
    references: Mapping[str, ScoreReference] | None,
    records: Path | None,
    progress: Progress,
) -> TrialAnalysis:
    """Return a registered trial with its score; arguments and errors of `scored_with_journal`."""
    progress(_READING, 0.0)
    return scored_with_journal(analysis, truth, scenario, references, records)


def explain(
    record: TrialRecord, scenario: Scenario, records: Path, progress: Progress
) -> TrialAnalysis:
    """Return the registration of a trial, with the touches explained by its journal.

    Raises:
        InputError: it cannot be registered.
    """
    progress(_READING, 0.0)
    return analyze_trial(record, scenario, trajectory=trajectory_of(record, records))


def explainProcedure(
    record: TrialRecord, scenario: Scenario, truth: RevealedTruth, progress: Progress
) -> ProcedureOutcome | None:
    """Return the errors of a stored trial's procedure; None where it is of another plan."""
    progress("Computing errors", 0.0)
    try:
        return procedure_outcome(record, scenario, truth.matrix)
    except InputError as error:
        # The trial itself can be shown all the same.
        logging.info("The lines of a procedure are not shown: %s", error)
        return None


def readTrack(records: Path, trialId: str, progress: Progress) -> ReplayTrack:
    """Return what is shown of a trial again; errors of `find_track`."""
    progress(_READING, 0.0)
    return find_track(records, trialId)
