"""The errors of procedures as a table: one trajectory per row, with both parts of each error."""

import csv
import io
from dataclasses import replace

import pytest

from rastrainer.study.tidy_csv import PROCEDURE_COLUMNS, procedures_csv
from Testing.simulator.report.studied_procedures import TOO_DEEP_MM, with_procedures
from Testing.simulator.report.test_report import cohort


@pytest.fixture(scope="module")
def data():
    return with_procedures(cohort(2))


def rows_of(trials):
    return list(csv.DictReader(io.StringIO(procedures_csv(trials))))


def test_every_trajectory_is_a_row_with_its_trial(data):
    rows = rows_of(data.trials)
    assert len(rows) == 2 * len(data.trials)
    assert tuple(rows[0]) == PROCEDURE_COLUMNS
    assert [row["trajectory"] for row in rows[:2]] == ["Left", "Right"]
    assert {row["kind"] for row in rows} == {"biopsy", "dbs", "seeg"}
    assert {row["procedure_score_version"] for row in rows} == {"procedure-1"}


def test_both_parts_of_an_error_are_exported_and_depth_errors_add_up(data):
    for row in rows_of(data.trials):
        parts = float(row["depth_by_registration_mm"]), float(row["depth_by_hand_mm"])
        assert sum(parts) == pytest.approx(float(row["depth_mm"]))
        assert parts[1] == pytest.approx(TOO_DEEP_MM)
        assert float(row["target_by_hand_mm"]) == pytest.approx(TOO_DEEP_MM)
        assert row["nearest_no_go"] == "Vessel"
    first = rows_of(data.trials[:1])[0]
    assert float(first["target_by_registration_mm"]) == pytest.approx(0.5)


def test_the_columns_of_the_hand_are_empty_where_the_robot_aligned_the_guide():
    rows = rows_of(with_procedures(cohort(1), by_robot=True).trials)
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
    assert rows_of(touches) == []
