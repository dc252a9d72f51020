"""Trials by landmarks or a trace, and on shifted skin: registered, scored, stored, reported."""

from dataclasses import replace

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList
from rastrainer.head.mesh import read_head_mesh
from rastrainer.head.trial_head import UNMOVED, SkinShift
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import RegistrationMethod
from rastrainer.scenario.scenario import load_scenario
from rastrainer.study.database.study import Study
from rastrainer.study.study_data import StudyData, trial_rows
from rastrainer.study.tidy_csv import trials_csv
from rastrainer.trial.analysis import RevealedTruth, analyze_trial
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.score_reference import score_reference
from rastrainer.trial.scoring import SAFETY_METRICS, ScoreMeasures, score_trial
from rastrainer.trial.touch_registration import GivenPoints, register_trial
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.report.target_errors import shifted_skin
from Testing.domain.trial.trial_records import make_record
from Testing.simulator.landmarked import LANDMARKS, OVER_THE_FACE, on_skin, with_landmarks
from Testing.simulator.report.test_report import words_of

SURFACE = RegistrationMethod.SURFACE
SLIP_MM = 4.0
"""The distance by which the landmarks are missed."""


@pytest.fixture(scope="module")
def scenario():
    return with_landmarks(load_scenario(asset_path("scenarios", "colin27")))


@pytest.fixture(scope="module")
def traced(scenario):
    """Return the points of a trainee who misses the landmarks and traces exactly."""
    head, pose = read_head_mesh(scenario.head), scenario.perturbed_head_to_world(8)
    trace = np.concatenate([on_skin(head, corners, 2.0) for corners in OVER_THE_FACE])
    missed = np.random.default_rng(4).normal(0.0, SLIP_MM / np.sqrt(3), (3, 3))
    places = np.array([landmark.position_ras for landmark in LANDMARKS[:3]]) + missed
    touches = PointList(
        tuple(landmark.name for landmark in LANDMARKS[:3]), transforms.apply(pose, places)
    )
    return GivenPoints("task-1", touches, SURFACE, transforms.apply(pose, trace)), pose


def off_target(scenario, registered, pose):
    target = scenario.target.position_ras
    found = transforms.apply(registered.rigid.matrix @ pose, target)
    return float(np.linalg.norm(found - target))


def test_a_trace_corrects_what_the_landmarks_missed(scenario, traced):
    given, pose = traced
    registered = register_trial(given, scenario)
    by_landmarks = replace(given, method=RegistrationMethod.LANDMARKS)
    coarse = register_trial(by_landmarks, replace(scenario, landmarks=LANDMARKS[:3]))
    assert off_target(scenario, registered, pose) < 0.2
    assert off_target(scenario, coarse, pose) > 1.0
    assert registered.rigid.fre_mm < 0.05
    assert list(registered.fits) == list(registered.target_errors) == ["rigid"]
    exact, missed = registered.target_errors["rigid"], coarse.target_errors["rigid"]
    assert exact.expected_mm < missed.expected_mm
    arguments = registered.arguments("a3bb189e-8bf9-4888-9912-ace4e6543002")
    assert arguments["freMm"] == registered.rigid.fre_mm


def answer_of(given):
    touches = zip(given.touches.labels, given.touches.points.tolist(), strict=True)
    return {
        "task": given.task,
        "method": given.method.value,
        "touches": [{"label": label, "positionMm": place} for label, place in touches],
        "trace": [[*place, 1.0] for place in given.trace_mm.tolist()],
    }


def test_an_unfinished_trial_is_registered_from_the_simulators_answer(scenario, traced):
    given, _pose = traced
    again = register_trial(GivenPoints.of_answer(answer_of(given)), scenario)
    np.testing.assert_array_equal(again.rigid.matrix, register_trial(given, scenario).rigid.matrix)


def test_the_reference_of_a_method_has_its_own_time_and_the_same_error(scenario):
    by_fiducials = score_reference(scenario, "task-1")
    by_surface = score_reference(scenario, "task-1", method=SURFACE)
    by_both = score_reference(scenario, "task-1", method=RegistrationMethod.LANDMARKS_SURFACE)
    assert by_surface.tre_mm == by_fiducials.tre_mm
    assert by_surface.limit_mm == by_fiducials.limit_mm
    assert by_surface.time_s < by_both.time_s < by_fiducials.time_s
    planned = {"task-1": replace(by_fiducials, time_s=99.0)}
    assert score_reference(scenario, "task-1", planned, SURFACE) == by_surface


def test_a_trial_without_fiducials_is_scored_without_a_common_bias(scenario):
    reference = score_reference(scenario, "task-1", method=SURFACE)
    measures = ScoreMeasures(40.0, 0.5, 0.0, 0.0, 0.0)
    score = score_trial(measures, reference, SURFACE)
    unbiased = score_trial(replace(measures, common_bias_mm=0.0), reference)
    assert score.score == unbiased.score
    assert score.is_unbiased is None
    assert score.acceptable
    with pytest.raises(InputError, match="common bias"):
        score_trial(measures, reference)


SKIN = SkinShift(4.0, 7, 0.5)


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
