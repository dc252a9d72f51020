"""What is told of a match before it is accepted is what the trial is registered with."""

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.protocol import Phase, RegistrationMethod
from rastrainer.trial.touch_registration import GivenPoints, register_trial
from rastrainer_simulator.flow.pages.trial import match_report
from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.training.replies import given
from rastrainer_simulator.trial_state import TouchState, TracedPoint, TraceState
from Testing.domain.registration.traces import colin27, places, traced
from Testing.simulator.landmarked import LANDMARKS, with_landmarks


@pytest.fixture(scope="module")
def landmarked(setup):
    return with_landmarks(setup.scenario)


def drawn(scenario, where):
    """Return a trial with a trace over a part of the head, its residual small."""
    mesh, random = colin27(), np.random.default_rng(5)
    trace = traced(mesh, places(mesh, where), random, scenario.head_to_world, 0.1, 60) / 1000.0
    touched = [transforms.apply(scenario.head_to_world, each.position) for each in LANDMARKS[:3]]
    return TrainingState(
        phase=Phase.COMPLETE,
        task="task-1",
        method=RegistrationMethod.SURFACE,
        touches=tuple(
            TouchState(each.name, tuple((place / 1000.0).tolist()), 0.0, 0.0)
            for each, place in zip(LANDMARKS[:3], touched, strict=True)
        ),
        trace=TraceState(
            tuple(TracedPoint(tuple(place), row, row) for row, place in enumerate(trace.tolist())),
            (0,),
        ),
    )


def test_the_report_has_the_numbers_of_the_registration(landmarked):
    trial = drawn(landmarked, "face")
    report = match_report(trial, landmarked)
    told = {"task": "task-1", "method": "surface", **given(trial)}
    registered = register_trial(GivenPoints.of_answer(told), landmarked)
    assert report.residual_mm == registered.rigid.fre_mm < 0.2
    assert report.expected_mm == registered.arguments("x")["expectedTreMm"]
    assert report.interval_mm[0] < report.expected_mm < report.interval_mm[1]
    assert "slides" not in report.codes


def test_a_trace_on_the_crown_alone_is_named_before_it_is_accepted(landmarked):
    report = match_report(drawn(landmarked, "crown"), landmarked)
    assert report.residual_mm < 0.2
    assert "slides" in report.codes
    assert report.slide_mm > 3.0
