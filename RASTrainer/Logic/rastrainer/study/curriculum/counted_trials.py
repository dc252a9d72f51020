"""The trials that count for assignments: scored ones, and aborted ones as failures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from rastrainer.procedure.score import ProcedureScore
from rastrainer.protocol import PROCEDURE_PHASES, TRIAL_RUN, RegistrationMethod
from rastrainer.study.curriculum.curriculum import Assignment
from rastrainer.study.database import study_trainees
from rastrainer.study.database.aborted_trials import stored_of
from rastrainer.study.database.database import Connection
from rastrainer.study.database.study_trainees import TRAINEE_ID
from rastrainer.study.database.study_trials import decoded
from rastrainer.study.database.values import StoredProcedure, moment
from rastrainer.trial.aborted_trial import AbortedTrial
from rastrainer.trial.scoring import TrialScore, method_of_version


@dataclass(frozen=True)
class CountedTrial:
    """A trial as a curriculum counts it.

    Attributes:
        task, mode, scenario: As recorded.
        method: By what it was registered, or would have been.
        procedure: That it continued with; "" for touches alone, and for aborted trials, which do
            not say which.
        score: Of the procedure where there is one, else of the touches; 0 of an aborted trial.
        acceptable: Whether it was within all limits of its score.
        version: Of the score; "" of an aborted trial.
        parts: Desirability of each part of the score, 0 to 1.
        is_aborted: Whether it was aborted after a touch.
        is_in_procedure: Whether it was aborted in a procedure.
        started_utc: ISO 8601.
    """

    task: str
    mode: str
    scenario: str = ""
    method: str = RegistrationMethod.FIDUCIALS.value
    procedure: str = ""
    score: float = 0.0
    acceptable: bool = False
    version: str = ""
    parts: Mapping[str, float] = field(default_factory=dict, hash=False)
    is_aborted: bool = False
    is_in_procedure: bool = False
    started_utc: str = ""

    def counts_for(self, assignment: Assignment) -> bool:
        """Return whether it was played as an assignment asks."""
        if (self.task, self.method) != (assignment.task, assignment.method):
            return False
        if assignment.mode not in ("", self.mode) or assignment.scenario not in ("", self.scenario):
            return False
        if self.is_aborted:
            return bool(assignment.procedure) or not self.is_in_procedure
        return self.procedure == assignment.procedure


def counted_trials(connection: Connection, pseudonym: str) -> tuple[CountedTrial, ...]:
    """Return a trainee's trials in order of starting; in the caller's transaction.

    Raises:
        InputError: an unknown trainee.
    """
    study_trainees.find(connection, pseudonym)
    rows = connection.execute(
        "SELECT started_utc, trials.stored_utc, task, mode, scenario, "
        "(SELECT score_json FROM scores WHERE scores.trial_id = trials.trial_id "
        "ORDER BY scores.id DESC LIMIT 1), "
        "(SELECT outcome_json FROM procedure_outcomes "
        "WHERE procedure_outcomes.trial_id = trials.trial_id "
        "ORDER BY procedure_outcomes.id DESC LIMIT 1) "
        f"FROM trials WHERE trainee_id = ({TRAINEE_ID}) AND task != ?",
        (pseudonym, TRIAL_RUN),
    )
    timed = [
        (moment(started), stored, _scored(started, task, mode, scenario, score, outcome))
        for started, stored, task, mode, scenario, score, outcome in rows
        if score is not None
    ]
    timed += [
        (moment(stored.record.started_utc), "", _aborted(stored.record))
        for stored in stored_of(connection, pseudonym)
        if stored.record.counts_as_failed
    ]
    return tuple(trial for *_when, trial in sorted(timed, key=lambda each: each[:2]))


def _scored(
    started: str, task: str, mode: str, scenario: str, score_json: str, outcome_json: str | None
) -> CountedTrial:
    score = decoded(score_json, TrialScore.from_json)
    method = method_of_version(score.version)
    found: TrialScore | ProcedureScore = score
    parts: Mapping[str, float] = score.parts
    procedure = ""
    if outcome_json is not None:
        outcome = decoded(outcome_json, StoredProcedure.from_json)
        found, parts, procedure = outcome.score, outcome.score.desirabilities, outcome.name
    return CountedTrial(
        task,
        mode,
        scenario,
        method,
        procedure,
        found.score,
        found.acceptable,
        found.version,
        parts,
        started_utc=started,
    )


def _aborted(record: AbortedTrial) -> CountedTrial:
    return CountedTrial(
        record.task,
        record.mode,
        record.scenario,
        record.method.value,
        is_aborted=True,
        is_in_procedure=record.phase in {phase.value for phase in PROCEDURE_PHASES},
        started_utc=record.started_utc,
    )
