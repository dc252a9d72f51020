"""Tables, xAPI and report of a study: answers, procedures, expected errors, consent."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.procedure.plan import ProcedureKind
from rastrainer.registration.distributions import proportion
from rastrainer.registration.target_error import INTERVAL_NOTE
from rastrainer.study.protocol.questionnaires import SSQ
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.study.study_data import StudyData, read_study_data
from rastrainer.study.tidy_csv import PROCEDURE_COLUMNS, answers_csv, procedures_csv, scores_csv
from rastrainer.study.tre_calibration import calibration_of
from rastrainer.trial.procedure_outcome import PROCEDURE_SCORE_VERSION
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.export.xapi import HOME_PAGE, statements
from rastrainer_simulator.report.target_errors import calibration
from Testing.domain.study.played_study import study_with_trials
from Testing.domain.study.study_content import table_of
from Testing.domain.trial.trial_records import gentle_score, make_record
from Testing.simulator.report.studied_procedures import (
    TOO_DEEP_MM,
    carried_out,
    outcome,
    with_procedures,
)
from Testing.simulator.report.test_report import cohort


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    path = tmp_path_factory.mktemp("exported") / "study.db"
    study_with_trials(path)
    return read_study_data(path)


def test_every_answer_and_every_score_is_a_row(data):
    items, scores = table_of(answers_csv(data)), table_of(scores_csv(data))
    before = [row for row in items if row["step"] == "hmd/before/ssq"]
    assert [row["item"] for row in before] == [item.name for item in SSQ.items]
    assert {(row["trainee"], row["mode"], row["answer"]) for row in before} == {("A", "hmd", "1")}
    assert len(items) == sum(len(answered.answers) for answered in data.answers)
    exported = {
        row["scale"]: float(row["score"]) for row in scores if row["step"] == "hmd/before/ssq"
    }
    assert exported == SSQ.score([1] * 16)


def test_a_trials_statement_has_success_and_completion_time(data):
    utc = {"started_utc": "2026-01-01T10:00:00Z", "completed_utc": "2026-01-01T10:01:50Z"}
    played = replace(data.trials[0], values={"completion_time_s": 110.0}, **utc)
    trials = [
        replace(played, values={**played.values, "score": score}, acceptable=acceptable)
        for score, acceptable in ((80.0, True), (80.0, False), (79.9, True))
    ]
    # The mark is for trials by fiducials only.
    trials += [replace(trials[0], method="surface"), played]
    protocol = replace(data.protocol, pass_mark=80.0)
    exported = statements(
        replace(data, trials=tuple(trials), protocol=protocol, answers=(), aborted=())
    )
    assert [s["result"].get("success") for s in exported] == [True, False, False, None, None]
    assert {s["version"] for s in exported} == {"1.0.0"}
    assert {s["timestamp"] for s in exported} == {"2026-01-01T10:01:50Z"}
    assert {s["result"]["duration"] for s in exported} == {"PT110.00S"}
    context = exported[0]["context"]["extensions"]
    assert context[f"{HOME_PAGE}/xapi/started"] == "2026-01-01T10:00:00Z"
    assert context[f"{HOME_PAGE}/xapi/pass-mark"] == 80.0


def test_trainees_without_consent_are_left_out_of_exports_and_counted(tmp_path, capsys):
    study_with_trials(tmp_path / "study.db", consent=False)
    words = ["export", tmp_path / "study.db", "-o", tmp_path / "out"]
    assert main([str(word) for word in words]) == 0
    assert "did not consent to research: 1 trainees" in capsys.readouterr().out
    for name in ("trials", "touches", "scores", "answers"):
        rows = table_of((tmp_path / "out" / "csv" / f"{name}.csv").read_text())
        assert {row["trainee"] for row in rows} <= {"B"}
    content = json.loads((tmp_path / "out" / "xapi" / "statements.json").read_text())
    assert {statement["actor"]["account"]["name"] for statement in content} == {"B"}


DBS = outcome(ProcedureKind.DBS)
DONE = carried_out(ProcedureKind.DBS)[1]


def record(number, procedure=None):
    value = make_record(
        number,
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
    # A trial read before is read anew.
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
def procedures():
    return with_procedures(cohort(2))


def test_every_trajectory_is_a_row_with_both_parts_of_its_errors_and_depths_add_up(procedures):
    rows = table_of(procedures_csv(procedures.trials))
    assert len(rows) == 2 * len(procedures.trials)
    assert tuple(rows[0]) == PROCEDURE_COLUMNS
    assert [row["trajectory"] for row in rows[:2]] == ["Left", "Right"]
    assert {row["kind"] for row in rows} == {"biopsy", "dbs", "seeg"}
    assert {row["procedure_score_version"] for row in rows} == {"procedure-1"}
    for row in rows:
        parts = float(row["depth_by_registration_mm"]), float(row["depth_by_hand_mm"])
        assert sum(parts) == pytest.approx(float(row["depth_mm"]))
        assert parts[1] == pytest.approx(TOO_DEEP_MM)
        assert float(row["target_by_hand_mm"]) == pytest.approx(TOO_DEEP_MM)
        assert row["nearest_no_go"] == "Vessel"
    assert float(rows[0]["target_by_registration_mm"]) == pytest.approx(0.5)


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


KNOWN = {"expected_tre_mm": 0.5, "tre_low_mm": 0.1, "tre_high_mm": 1.0}


def row(number, mode="desktop", **values):
    return TrialRow("T-001", mode, "task-1", number, {"completion_time_s": 90.0, **values})


def report(*rows):
    # A number and its unit stay on one line.
    return calibration(StudyData("Study", rows)).replace("\N{NO-BREAK SPACE}", " ")


def test_trials_are_ordered_by_expected_error_and_judged_by_their_interval():
    trials = [{"true_tre_mm": 2.0, "expected_tre_mm": 0.9}, {"true_tre_mm": 0.3}]
    trials += [{"true_tre_mm": 0.05}]
    found = calibration_of(row(1, **KNOWN | errors) for errors in trials)
    assert [one.expected_mm for one in found.points] == [0.5, 0.5, 0.9]
    assert [one.is_inside for one in found.points] == [False, True, False]
    assert found.above == 1
    assert found.true_rms_mm == pytest.approx(np.sqrt((4 + 0.09 + 0.0025) / 3))


@pytest.mark.parametrize(("count", "total"), [(0, 3), (3, 3), (57, 60), (1, 1)], ids=str)
def test_the_interval_of_a_proportion_is_wilsons(count, total):
    theirs = stats.binomtest(count, total).proportion_ci(0.95, "wilson")
    found = proportion(count, total).interval
    assert found == pytest.approx((theirs.low, theirs.high), abs=1e-12)


def test_the_report_counts_missing_errors_and_separates_modes():
    page = report(
        *(row(n, **KNOWN, true_tre_mm=0.4, tre_common_bias_sd_mm=0.25) for n in range(1, 8)),
        row(1, "hmd", **KNOWN, true_tre_mm=3.0, tre_common_bias_sd_mm=0.25),
        row(2, "hmd", **KNOWN),
        row(3, "hmd"),
    )
    assert "7 of 8 true errors (88 % [53, 98])" in page
    assert "larger: 1, smaller: 0" in page
    assert page.count("cannot be shown") == 2
    assert "of the intervals were computed before" not in page
    assert ">all</th><td>8</td>" in page
    assert "T-001, task-1: true 3.00 mm, expected 0.50 mm" in page
    assert INTERVAL_NOTE in page
