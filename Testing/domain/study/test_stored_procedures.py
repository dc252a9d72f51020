"""The outcome of a procedure is stored with its trial, asked for by a step, and exported."""

from dataclasses import replace

import pytest

from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.procedure.plan import ProcedureKind
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.study.tidy_csv import PROCEDURE_COLUMNS, procedures_csv
from rastrainer.trial.procedure_outcome import PROCEDURE_SCORE_VERSION
from rastrainer.trial.record import TrialRecord
from Testing.domain.study.study_content import table_of
from Testing.domain.trial.trial_records import gentle_score, make_record
from Testing.simulator.report.studied_procedures import (
    TOO_DEEP_MM,
    carried_out,
    outcome,
    with_procedures,
)
from Testing.simulator.report.test_report import cohort

DBS = outcome(ProcedureKind.DBS)
DONE = carried_out(ProcedureKind.DBS)[1]


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


@pytest.fixture(scope="module")
def data():
    return with_procedures(cohort(2))


def test_every_trajectory_is_a_row_with_its_trial(data):
    rows = table_of(procedures_csv(data.trials))
    assert len(rows) == 2 * len(data.trials)
    assert tuple(rows[0]) == PROCEDURE_COLUMNS
    assert [row["trajectory"] for row in rows[:2]] == ["Left", "Right"]
    assert {row["kind"] for row in rows} == {"biopsy", "dbs", "seeg"}
    assert {row["procedure_score_version"] for row in rows} == {"procedure-1"}


def test_both_parts_of_an_error_are_exported_and_depth_errors_add_up(data):
    for row in table_of(procedures_csv(data.trials)):
        parts = float(row["depth_by_registration_mm"]), float(row["depth_by_hand_mm"])
        assert sum(parts) == pytest.approx(float(row["depth_mm"]))
        assert parts[1] == pytest.approx(TOO_DEEP_MM)
        assert float(row["target_by_hand_mm"]) == pytest.approx(TOO_DEEP_MM)
        assert row["nearest_no_go"] == "Vessel"
    first = table_of(procedures_csv(data.trials[:1]))[0]
    assert float(first["target_by_registration_mm"]) == pytest.approx(0.5)


def test_the_columns_of_the_hand_are_empty_where_the_robot_aligned_the_guide():
    rows = table_of(procedures_csv(with_procedures(cohort(1), by_robot=True).trials))
    assert [row["aligned_by"] for row in rows[:2]] == ["robot", "hand"]
    for row in rows:
        by_robot = row["aligned_by"] == "robot"
        for hand, robot in (
            ("entry_by_hand_mm", "entry_by_robot_mm"),
            ("target_by_hand_mm", "target_by_robot_and_hand_mm"),
            ("angle_by_hand_deg", "angle_by_robot_deg"),
        ):
            assert (row[hand] == "", row[robot] == "") == (by_robot, not by_robot)
        assert float(row["depth_by_hand_mm"]) == pytest.approx(TOO_DEEP_MM * (1 + by_robot))


def test_trials_without_a_procedure_have_no_row(data):
    touches = [replace(trial, procedure=None) for trial in data.trials]
    assert table_of(procedures_csv(touches)) == []
