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
    scoreRows,
    standings,
)
from rastrainer.slicer.scene.tables import showCalibration, showLearningCurve
from rastrainer.study.database.study import Study
from rastrainer.study.study_data import trial_rows
from rastrainer.study.tidy_csv import write_histories
from rastrainer.study.tre_calibration import calibration_of
from rastrainer.trial.analysis import RevealedTruth
from rastrainer.trial.ctps import CTPS_WARNING, RMSE, TIME
from rastrainer.trial.trial_row import TrialRow
from Testing.domain.trial.trial_records import gentle_score, make_traced
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
    other = replace(trials[0].record, method=RegistrationMethod.LANDMARKS)
    chart = showLearningCurve(scene, "a", [replace(trials[0], record=other), trials[1]])
    assert chart.GetTitle().endswith("(scores by fiducials and landmarks cannot be compared)")


def test_true_and_expected_errors_of_all_trainees_are_a_table_and_a_plot(
    scene, logic, add_trial, tmp_path
):
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
    (_, right), (_, top) = chart.GetXAxisRange(), chart.GetYAxisRange()
    assert (right > expected.max(), top > 6.0) == (True, True)
    messages = VtkMessages()
    try:
        for shown in ([], trials[:1]):
            draw_chart(showCalibration(scene, calibration_of(trial_rows(shown))), 200, 150)
            draw_chart(showLearningCurve(scene, "a", trials[:1]), 200, 150)
        storage, again = slicer.vtkMRMLTableStorageNode(), slicer.vtkMRMLTableNode()
        storage.SetFileName(str(tmp_path / "table.tsv"))
        assert storage.WriteData(table)
        assert storage.ReadData(again)
        assert again.GetNumberOfRows() == table.GetNumberOfRows() == 2
    finally:
        messages.close()
    assert FAILURES.texts == []


def test_the_score_is_shown_with_its_parts_and_ctps_with_its_warning(add_trial):
    trial = add_trial(1)
    rows = {row.title: row for row in [*scoreRows(trial), *ctpsRows(trial, COHORT)]}
    assert rows["Score"].value == trial.score.score
    assert rows["… its part for time"].value == 100 * trial.score.time_desirability
    assert rows["CTPS as published"].note == CTPS_WARNING
    assert rows["True TRE at the target"].text == "0.20 mm"
    assert rows["True TRE in the brain"].value == trial.score.measures.tre_mm
    assert rows["True TRE in the brain"].note == "RMS over targets and brain; at most 1.5 mm"
    assert rows["Bias that all touches share"].value == trial.score.measures.common_bias_mm
    assert rows["Bias that all touches share"].note == "at most 1.5 mm"
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


def test_a_score_is_compared_only_with_those_of_the_same_method(logic, add_trial):
    traced = make_traced(trialId=str(uuid.UUID(int=1)), trainee="b")
    logic.study.add_trial(traced, score=gentle_score(60.0, 0.1))
    found = standings(logic.study, add_trial(2, trainee="a"))
    assert [each.title for each in found if each.group == "others"] == ["Completion time"]
