"""The outcome of a procedure is stored with its trial, and a step can require it."""

from dataclasses import replace

import pytest

from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.procedure.plan import ProcedureKind
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.trial.procedure_outcome import PROCEDURE_SCORE_VERSION
from rastrainer.trial.record import TrialRecord
from Testing.domain.trial.trial_records import gentle_score, make_record
from Testing.simulator.report.studied_procedures import TOO_DEEP_MM, carried_out, outcome

DBS = outcome(ProcedureKind.DBS)
DONE = carried_out(ProcedureKind.DBS)[1]


@pytest.fixture
def study(study_place):
    with Study.open(study_place) as opened:
        yield opened


def record(number, procedure=None):
    value = make_record(
        trialId=f"00000000-0000-0000-0000-00000000000{number}",
        startedUtc=f"2999-01-01T10:0{number}:00Z",
        completedUtc=f"2999-01-01T10:0{number}:30Z",
    )
    if procedure is not None:
        value["procedure"] = record_to_json(procedure)
    return record_from_json(TrialRecord, value)


def test_an_outcome_is_stored_beside_the_score_of_the_touches(study):
    trial = record(1, DONE)
    study.add_trial(trial, score=gentle_score(110.0, 0.5))
    assert study.trial(trial.trial_id).procedure is None
    assert study.history(trial.trainee)[0].procedure is None
    study.add_results(trial.trial_id, score=gentle_score(110.0, 0.5), procedure=DBS)
    stored = study.trial(trial.trial_id)
    assert stored.procedure.score == DBS.score
    assert stored.procedure.score.version == PROCEDURE_SCORE_VERSION
    assert stored.score.version != PROCEDURE_SCORE_VERSION
    assert stored.procedure == DBS
    assert (DBS.analysis.procedure, DBS.analysis.kind) == ("dbs", "dbs")
    first = stored.procedure.analysis.trajectories[0]
    assert first.target_point_error.by_registration_mm == pytest.approx(0.5)
    assert first.depth_error_by_hand_mm == pytest.approx(TOO_DEEP_MM)
    # What was read before is read again.
    assert study.history(trial.trainee)[0].procedure == stored.procedure


def test_the_outcome_is_deleted_with_its_trainee(study):
    trial = record(1, DONE)
    study.add_trial(trial, score=gentle_score(110.0, 0.5))
    study.add_results(trial.trial_id, procedure=DBS)
    study.delete_trainee(trial.trainee)
    assert study.database.row("SELECT count(*) FROM results") == (0,)


def test_only_a_trial_with_the_procedure_counts_for_a_step_that_asks_for_it(study):
    protocol = StudyProtocol(
        "p", "P", ("desktop",), "fixed", ("task-2",), "fixed", procedures={"task-2": "dbs"}
    )
    progress = StudyProgress(study)
    progress.set_protocol(protocol)
    trainee = record(1).trainee
    study.create_trainee(trainee)
    progress.enroll(trainee)
    played = {"task": "task-2", "mode": "desktop"}
    for number, procedure in enumerate([None, carried_out(ProcedureKind.SEEG)[1], DONE], start=1):
        study.add_trial(
            replace(record(number, procedure), **played), score=gentle_score(110.0, 0.5)
        )
        counted = progress.count_played(trainee).counted_trials
        assert counted == ((record(3).trial_id,) if number == 3 else ())
