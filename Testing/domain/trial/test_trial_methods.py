"""A trial by landmarks or a trace: registered by its method, scored, and compared with its like."""

from dataclasses import replace

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList
from rastrainer.head.mesh import read_head_mesh
from rastrainer.protocol import RegistrationMethod
from rastrainer.scenario.scenario import load_scenario
from rastrainer.trial.score_reference import score_reference
from rastrainer.trial.scoring import ScoreMeasures, score_trial
from rastrainer.trial.touch_registration import GivenPoints, register_trial
from rastrainer_simulator.assets import asset_path
from Testing.simulator.landmarked import LANDMARKS, OVER_THE_FACE, on_skin, with_landmarks

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


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        pytest.param({"trace": None}, "a list of at most 500 points", id="no trace"),
        pytest.param(
            {"trace": [[1.0, 2.0, 3.0, 4.0]]}, "trace must be a list of 30 points", id="too short"
        ),
        pytest.param({"touches": []}, "touches must be a list of 3 to 15", id="no landmark"),
        pytest.param({"method": "fiducials"}, "touches must be a list of 15", id="fiducials"),
        pytest.param(
            {"method": "laser"}, "method must be one of fiducials, landmarks", id="unknown"
        ),
    ],
)
def test_an_answer_that_cannot_be_registered_is_refused_with_a_message(traced, changes, said):
    with pytest.raises(InputError, match=said):
        GivenPoints.of_answer({**answer_of(traced[0]), **changes})


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
