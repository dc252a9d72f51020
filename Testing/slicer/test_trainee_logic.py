"""Trainees are created, archived, exported and deleted; their history is a table and a plot."""

import csv
import uuid
from dataclasses import replace

import numpy as np
import pytest
import slicer

from rastrainer.errors import InputError
from rastrainer.procedure.plan import ProcedureKind
from rastrainer.protocol import RegistrationMethod
from rastrainer.sections.trainees_logic import TraineeLogic, calibration
from rastrainer.slicer.scene.nodes import Role
from rastrainer.slicer.scene.score_tables import (
    ctpsRows,
    motionRows,
    scoreRows,
    showRows,
    showStandings,
    standings,
)
from rastrainer.slicer.scene.tables import showCalibration, showLearningCurve
from rastrainer.study.database.study import Study
from rastrainer.study.tidy_csv import write_histories
from rastrainer.trial.analysis import RevealedTruth
from rastrainer.trial.ctps import CTPS_WARNING, RMSE, TIME
from rastrainer.trial.scoring import score_trial
from rastrainer.trial.trial_row import TrialRow
from Testing.domain.trial.trial_records import REFERENCE, gentle_score, make_traced
from Testing.simulator.report.studied_procedures import outcome
from Testing.slicer.host.failures import FAILURES, VtkMessages
from Testing.slicer.host.pictures import draw_chart
from Testing.slicer.recorded_trial import scored_analysis

COHORT = [
    TrialRow(str(n), "desktop", "1", values={TIME: 80.0 + 10.0 * n, RMSE: 1.0 + 0.1 * n})
    for n in range(4)
]


@pytest.fixture
def logic(tmp_path):
    logic = TraineeLogic(lambda: Study.open(tmp_path / "study.db"), tmp_path / "journals")
    yield logic
    logic.close()


@pytest.fixture
def add_trial(logic, make_record, scenario):
    """Returns a function that stores a scored trial."""

    def add(number, **changes):
        record = make_record(
            str(uuid.UUID(int=number)),
            seed=number,
            startedUtc=f"2026-03-02T09:{number:02d}:00Z",
            **changes,
        )
        analysis = scored_analysis(record, scenario)
        fits, errors = analysis.fits.values(), analysis.target_errors
        logic.study.add_trial(record, fits, errors, analysis.score)
        logic.study.add_results(
            record["trialId"], truth=RevealedTruth(tuple([0.0] * 16), 0.2 * number)
        )
        return logic.study.trial(record["trialId"])

    return add


def test_a_new_trainee_is_chosen_and_an_archived_one_listed_only_on_request(logic):
    received = []
    logic.changed.connect(lambda: received.append(logic.chosen))
    assert logic.create("", consent=True).pseudonym == "T001"
    assert logic.create(" Blue ", consent=False).pseudonym == "Blue"
    assert (received, logic.chosen) == (["T001", "Blue"], "Blue")
    with pytest.raises(InputError, match="taken"):
        logic.create("Blue", consent=False)
    logic.change(archived=True)
    assert [trainee.pseudonym for trainee in logic.trainees()] == ["T001"]
    assert [each.pseudonym for each in logic.trainees(archived=True)] == ["T001", "Blue"]


def test_a_deleted_trainee_is_removed_and_journals_elsewhere_are_named(logic, add_trial, tmp_path):
    add_trial(1, trainee="gone")
    logic.choose("gone")
    erased = logic.delete()
    assert (erased.trials, erased.journals) == (1, 0)
    assert "The journals of 1 trials were not found" in erased.warnings[0]
    assert (logic.chosen, logic.history(), logic.chosenTrainee()) == ("", (), None)
    logic.create("a", consent=False)
    with Study.open(tmp_path / "study.db") as another_slicer:
        another_slicer.delete_trainee("a")
    assert (logic.history(), logic.chosenTrainee()) == ((), None)


def test_a_table_of_everyone_has_only_those_who_consented_to_research(logic, add_trial, tmp_path):
    add_trial(1, trainee="a")
    add_trial(2, trainee="b")
    with pytest.raises(InputError, match=r"No trainee of this study consented .* \(2 did not\)"):
        logic.inStudy(lambda study: write_histories(study, tmp_path / "all.csv"))
    assert not (tmp_path / "all.csv").exists()
    logic.choose("b")
    logic.change(consent=True)
    logic.change(archived=True)
    assert logic.inStudy(lambda study: write_histories(study, tmp_path / "all.csv")) == (1, 1)
    with (tmp_path / "all.csv").open(newline="") as file:
        assert [row["trainee"] for row in csv.DictReader(file)] == ["b"]


def test_the_history_is_a_table_and_two_learning_curves_with_room_for_more(scene, add_trial):
    trials = [add_trial(number, trainee="a") for number in range(1, 8)]
    chart = showLearningCurve(scene, "a", trials[:3])
    assert chart.GetTitle() == "Learning curve of a"
    assert chart.GetXAxisRange() == (0.0, 5.0)
    assert showLearningCurve(scene, "a", trials) is chart
    assert chart.GetNumberOfPlotSeriesNodes() == 2
    scores = slicer.util.arrayFromTableColumn(Role.HISTORY.find(scene), "score")
    assert scores.tolist() == [trial.score.score for trial in trials]
    table = Role.LEARNING_TABLE.find(scene)
    for index in range(2):
        series = chart.GetNthPlotSeriesNode(index)
        assert series.GetTableNodeID() == table.GetID()
        assert table.GetColumnIndex(series.GetYColumnName()) >= 0
    assert chart.GetXAxisRange() == (0.0, 8.0)
    low, high = chart.GetYAxisRange()
    assert (low, high > max(trial.record.completion_time_s for trial in trials)) == (0.0, True)
    assert not chart.GetXAxisRangeAuto()


def test_true_and_expected_errors_of_all_trainees_are_a_table_and_a_plot(scene, logic, add_trial):
    trials = [add_trial(number, trainee=name) for number, name in ((1, "a"), (2, "b"), (30, "a"))]
    logic.study.change_trainee("b", archived=True)
    found = logic.inStudy(calibration)
    assert [point.true_mm for point in found.points if not point.is_inside] == [6.0]
    chart = showCalibration(scene, found)
    assert showCalibration(scene, found) is chart
    assert chart.GetTitle().startswith("True against expected TRE: 2 of 3 inside, 67 % [21, 94]")
    table = Role.CALIBRATION_TABLE.find(scene)
    expected = slicer.util.arrayFromTableColumn(table, "expected TRE (mm)")
    assert sorted(expected) == sorted(t.registrations["rigid"].expected_tre_mm for t in trials)
    outside = slicer.util.arrayFromTableColumn(table, "true TRE, outside (mm)")
    assert np.isnan(outside).sum() == 2
    assert np.nanmax(outside) == 6.0
    series = [chart.GetNthPlotSeriesNode(i) for i in range(chart.GetNumberOfPlotSeriesNodes())]
    assert {one.GetXColumnName() for one in series} == {"expected TRE (mm)"}
    for one in series:
        assert one.GetTableNode().GetColumnIndex(one.GetYColumnName()) >= 0
    assert sum(one.GetMarkerStyle() == one.MarkerStyleNone for one in series) == 3
    (_, right), (_, top) = chart.GetXAxisRange(), chart.GetYAxisRange()
    assert (right > expected.max(), top > 6.0) == (True, True)


def test_plots_of_one_trial_or_none_leave_the_log_empty(scene, logic, add_trial, make_record):
    messages = VtkMessages()
    try:
        logic.study.add_trial(make_record(str(uuid.UUID(int=7))))
        found = logic.inStudy(calibration)
        chart = showCalibration(scene, found)
        assert chart.GetTitle() == "True against expected TRE"
        assert found.sentences()[0] == "No trial has both an expected and a true target error."
        draw_chart(chart, 200, 150)
        trial = add_trial(1, trainee="a")
        assert len(logic.inStudy(calibration).points) == 1
        for chart in (
            showCalibration(scene, logic.inStudy(calibration)),
            showLearningCurve(scene, "a", [trial]),
        ):
            draw_chart(chart, 200, 150)
    finally:
        messages.close()
    assert FAILURES.texts == []


def test_a_learning_curve_over_two_methods_says_so(scene, add_trial):
    first, second = add_trial(1), add_trial(2)
    other = replace(first, record=replace(first.record, method=RegistrationMethod.LANDMARKS))
    chart = showLearningCurve(scene, "T-001", [other, second])
    assert chart.GetTitle().endswith("(scores by fiducials and landmarks cannot be compared)")


def test_the_score_is_shown_with_its_parts_and_ctps_with_its_warning(add_trial):
    trial = add_trial(1)
    rows = {row.title: row for row in [*scoreRows(trial), *ctpsRows(trial, COHORT)]}
    assert rows["Score"].value == trial.score.score
    assert rows["… its part for time"].value == 100 * trial.score.time_desirability
    assert rows["CTPS as published"].note == CTPS_WARNING
    assert rows["CTPS by equation 3"].value == rows["CTPS as published"].value / 2
    assert rows["True TRE at the target"].text == "0.20 mm"
    assert rows["True TRE in the brain"].value == trial.score.measures.tre_mm
    assert rows["True TRE in the brain"].note == "RMS over targets and brain; at most 1.5 mm"
    assert rows["Bias that all touches share"].value == trial.score.measures.common_bias_mm
    assert rows["Bias that all touches share"].note == "at most 1.5 mm"
    assert rows["… its part for safety"].value == 100 * trial.score.safety_desirability
    assert rows["Unintended contact"].note == "at most 8 s"
    assert ctpsRows(trial, []) == []


def test_the_score_of_a_procedure_is_shown_beside_that_of_the_touches(logic, add_trial):
    trial = add_trial(1)
    assert "Score of the procedure" not in {row.title for row in scoreRows(trial)}
    dbs = outcome(ProcedureKind.DBS)
    logic.study.add_results(trial.record.trial_id, procedure=dbs)
    rows = {row.title: row for row in scoreRows(logic.study.trial(trial.record.trial_id))}
    assert rows["Score"].value == trial.score.score
    assert rows["Score of the procedure"].value == dbs.score.score
    assert rows["Score of the procedure"].note == "Version procedure-1"
    assert rows["… target point error"].note == "registration 0.50 mm, hand 1.20 mm"
    assert rows["… target point error"].value == dbs.analysis.target_point_error_rms_mm


def test_a_trial_is_compared_with_the_trainees_own_others_and_a_reference_group(logic, add_trial):
    add_trial(1, trainee="a", completionTimeS=120.0)
    add_trial(2, trainee="b", completionTimeS=60.0)
    add_trial(3, trainee="b", task="task-2", completionTimeS=10.0)
    trial = add_trial(4, trainee="a", completionTimeS=90.0)
    found = {(s.group, s.title): s for s in standings(logic.study, trial, COHORT)}
    own = found["own", "Completion time"]
    assert (own.count, own.median, own.betterThan) == (1, 120.0, 1.0)
    others = found["others", "Completion time"]
    assert (others.count, others.median, others.betterThan) == (1, 60.0, 0.0)
    reference = found["reference", "Completion time"]
    assert (reference.count, reference.median, reference.betterThan) == (4, 95.0, 0.5)


def test_the_score_of_a_trial_beyond_a_limit_is_called_not_acceptable(logic, add_trial):
    trial = add_trial(1)
    logic.study.add_results(trial.record.trial_id, score=gentle_score(60.0, 9.0))
    beyond = logic.study.trial(trial.record.trial_id)
    notes = {row.title: row.note for row in scoreRows(beyond)}
    assert notes["Score"] == "not acceptable; version 1"
    assert notes["… its part for accuracy"] == "beyond a limit"
    measures = replace(gentle_score(60.0, 0.3).measures, common_bias_mm=None)
    score = score_trial(measures, REFERENCE, RegistrationMethod.SURFACE)
    notes = {row.title: row.note for row in scoreRows(replace(trial, score=score))}
    assert notes["Score"] == "Version 1"
    assert notes["… its part for accuracy"] == "within the limit of 1.5 mm"
    assert "Bias that all touches share" not in notes


def test_a_score_is_compared_only_with_those_of_the_same_method(logic, add_trial):
    traced = make_traced(trialId=str(uuid.UUID(int=1)), trainee="b")
    logic.study.add_trial(traced, score=gentle_score(60.0, 0.1))
    found = standings(logic.study, add_trial(2, trainee="a"))
    assert [each.title for each in found if each.group == "others"] == ["Completion time"]


def test_score_comparison_and_motion_become_tables_in_the_scene(scene, logic, add_trial):
    trial = add_trial(1, motion={"path_length_mm": 2500.0, "sparc": -1.9})
    shown = [(row.title, row.text) for row in motionRows(trial)]
    assert shown == [("Path length", "2500.00 mm"), ("Smoothness, SPARC", "−1.90")]
    assert all(len(row.note) > 20 for row in motionRows(trial))
    showRows(scene, Role.SCORE, [*scoreRows(trial), *ctpsRows(trial, COHORT)])
    showStandings(scene, standings(logic.study, trial, COHORT))
    showRows(scene, Role.MOTION, motionRows(trial))
    for role, rows in ((Role.SCORE, 15), (Role.COMPARISON, 2), (Role.MOTION, 2)):
        assert role.find(scene).GetNumberOfRows() == rows
