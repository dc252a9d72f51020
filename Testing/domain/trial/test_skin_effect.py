"""The effect of a skin shift on a trial is shown after it, stored, exported and reported."""

from dataclasses import replace

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import read_head_mesh
from rastrainer.head.trial_head import UNMOVED, SkinShift
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.scenario.scenario import load_scenario
from rastrainer.study.database.study import Study
from rastrainer.study.study_data import StudyData, trial_rows
from rastrainer.study.tidy_csv import trials_csv
from rastrainer.trial.analysis import RevealedTruth, analyze_trial, score_arguments
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import SAFETY_METRICS
from rastrainer.trial.touch_registration import unshifted_tre_mm
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.report.target_errors import shifted_skin
from Testing.domain.trial.trial_records import make_record
from Testing.simulator.report.test_report import words_of

SKIN = SkinShift(4.0, 7, 0.5)


@pytest.fixture(scope="module")
def scenario():
    return load_scenario(asset_path("scenarios", "colin27"))


def touched(scenario, skin):
    """Return a trial whose fiducials were touched exactly on such skin, and its pose."""
    pose, task = scenario.perturbed_head_to_world(8), scenario.task("task-1")
    places = transforms.apply(pose, skin.measured(task.fiducials, read_head_mesh(scenario.head)))
    value = make_record(trainee="P01", motion=dict.fromkeys(SAFETY_METRICS, 0.0))
    for point, place in zip(value["points"], places.tolist(), strict=True):
        point["positionMm"] = place
    record = replace(record_from_json(TrialRecord, value), skin=skin)
    assert record.skin.seed == 0
    return record, pose


def scored(scenario, skin):
    record, pose = touched(scenario, skin)
    analysis = analyze_trial(record, scenario)
    off = transforms.apply(analysis.rigid.matrix @ pose, scenario.target.position_ras)
    tre_mm = float(np.linalg.norm(off - scenario.target.position_ras))
    truth = RevealedTruth(tuple(pose.ravel().tolist()), tre_mm, skin)
    return analysis.scored(scenario, truth), truth


def test_the_error_without_the_shift_is_computed_from_the_points_moved_back(scenario):
    record, pose = touched(scenario, SKIN)
    assert unshifted_tre_mm(record, scenario, pose, SKIN) < 0.02
    assert unshifted_tre_mm(record, scenario, pose, UNMOVED) is None


def test_one_sentence_describes_the_shift_and_its_effect(scenario):
    analysis, truth = scored(scenario, SKIN)
    assert truth.true_tre_mm > 0.5
    (sentence,) = analysis.feedback.skin
    assert sentence == (
        "The skin had shifted by 4.0 mm (RMS) and was indented by 0.5 mm: the true error at the "
        f"target was {truth.true_tre_mm:.2f} mm, and would have been "
        f"{analysis.score.unshifted_tre_mm:.2f} mm without that."
    )
    first = score_arguments(analysis)["details"]["feedback"][0]
    assert (first["key"], first["text"]) == ("skin and error", sentence)
    assert sentence in analysis.feedback.sentences


def test_unshifted_skin_leaves_score_and_record_unchanged(scenario):
    analysis, _truth = scored(scenario, UNMOVED)
    assert analysis.feedback.skin == ()
    assert "unshiftedTreMm" not in record_to_json(analysis.score)
    assert "skin" not in record_to_json(analysis.record)


def test_a_study_stores_the_skin_shift_and_shows_it_in_tables_and_report(scenario, tmp_path):
    analysis, truth = scored(scenario, SKIN)
    record = analysis.record
    with Study.open(tmp_path / "study.db") as study:
        study.add_trial(
            record, analysis.fits.values(), analysis.target_errors, delivered=record_to_json(record)
        )
        study.add_results(record.trial_id, score=analysis.score)
        study.add_results(
            record.trial_id, truth=RevealedTruth(tuple(truth.head_to_world), truth.true_tre_mm)
        )
        (stored,) = study.history("P01")
    again = analyze_trial(stored.record, scenario).scored_as(stored.score, scenario, stored.truth)
    assert again.feedback.skin == analysis.feedback.skin
    rows = trial_rows([stored])
    header, values = (line.split(",") for line in trials_csv(rows).splitlines())
    cells = dict(zip(header, values, strict=True))
    assert (cells["skin_shift_mm"], cells["skin_indentation_mm"]) == ("4.0", "0.5")
    assert float(cells["unshifted_tre_mm"]) == analysis.score.unshifted_tre_mm
    words = words_of(shifted_skin(StudyData("Skin", tuple(rows))))
    without = f"{truth.true_tre_mm:.2f} {analysis.score.unshifted_tre_mm:.2f}"
    assert "4.0 0.5 Fiducials 1" in words
    assert without in words
    plain = replace(rows[0], values={"true_tre_mm": 1.0})
    assert shifted_skin(StudyData("Skin", (plain,))) == ""


def test_a_truth_with_an_impossible_skin_shift_is_refused():
    answer = {"headToWorld": np.eye(4).ravel().tolist(), "trueTreMm": 1.0}
    assert record_from_json(RevealedTruth, answer).skin == UNMOVED
    with pytest.raises(InputError, match=r"skin\.seed must be a whole number"):
        record_from_json(RevealedTruth, {**answer, "skin": {"shiftMm": 1.0, "seed": -1}})
