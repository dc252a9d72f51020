"""A trace by the trainee's own controls, and the report of its match before it counts."""

from __future__ import annotations

from concurrent.futures import Future
from dataclasses import replace

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.protocol import MIN_TRACE_POINTS, Phase, RegistrationMethod
from rastrainer.registration.fits import RIGID
from rastrainer.registration.surface_error import COVERED_MM
from rastrainer.trial.touch_registration import GivenPoints, register_trial
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.flow.session.chosen_trial import registration_method, start_task
from rastrainer_simulator.flow.trial_screen import match_page, registration_so_far
from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.training.replies import given
from rastrainer_simulator.trial_state import TouchState, TracedPoint, TraceState
from Testing.domain.registration import traces
from Testing.simulator.flow.every_page import known_match
from Testing.simulator.landmarked import LANDMARKS, with_landmarks


@pytest.fixture(scope="module")
def shared(anywhere):
    """Return a simulation with landmarks in which everything counts, also in the air."""
    training = replace(anywhere.settings.training, landmark_radius=10.0, skin_tolerance=10.0)
    settings = replace(anywhere.settings, training=training)
    return Simulation(
        replace(anywhere, scenario=with_landmarks(anywhere.scenario), settings=settings), 3
    )


def traced(trainee):
    return len(trainee.state.training.trace.points)


def landmarks_touched(trainee):
    """Start a trial by surface, and touch its landmarks as the screen asks for them."""
    assert trainee.submit("StartTask", task="task-1", trainee="P07", method="surface").ok
    trainee.until_menu(None)
    for number, landmark in enumerate(LANDMARKS[:3]):
        assert landmark.name in trainee.presenter.screen.instruction.text
        assert trainee.presenter.screen.status[1] == f"{number} of 3 points"
        trainee.tap("touch")
        trainee.until(lambda number=number: trainee.touched > number, "the touch")
        trainee.step()


def draw_stroke(trainee):
    """Begin a stroke, draw enough points to register, and end it."""
    trainee.tap("touch")
    trainee.until(lambda: trainee.state.training.trace.is_on, "a stroke")
    trainee.hands.push(0.9, 0.0, 0.0, fine=False)
    trainee.until(lambda: traced(trainee) > MIN_TRACE_POINTS, "the points")
    trainee.hands.push(0.0, 0.0, 0.0, fine=False)
    trainee.tap("touch")


def guidance(trainee):
    return trainee.presenter.trace_guidance(trainee.state)


def facts(trainee):
    return " | ".join(trainee.presenter.screen.status)


def test_guidance_paints_what_is_covered_and_shows_where_to_draw_next(trainee):
    trainee.presenter._session.prefer(guidance="words")
    landmarks_touched(trainee)
    trainee.until(lambda: guidance(trainee).next_place is not None, "the next place")
    assert guidance(trainee).covered_mm == COVERED_MM
    trainee.until(lambda: trainee.presenter.screen.coverage, "the legend")
    assert trainee.presenter.screen.has_arrow
    trainee.until(lambda: "Next: " in facts(trainee), "the words")
    first = guidance(trainee).next_place
    trainee.tap("best_view")
    to_world = trainee.state.head_to_world
    place = to_world[:3, :3] @ first.position_mm / 1000.0 + to_world[:3, 3]
    seen = lambda: trainee.presenter.pictures(trainee.state).main  # noqa: E731
    trainee.until(lambda: np.allclose(seen().focal_point, place, atol=0.002), "its view")
    draw_stroke(trainee)
    trainee.until(lambda: guidance(trainee).next_place != first, "a different next place")


def test_landmarks_strokes_and_the_registration_are_made_with_the_trainees_controls(trainee):
    landmarks_touched(trainee)
    assert trainee.presenter.screen.status[1] == "0 of 30–500 points traced"
    assert "trace the skin with the tip" in trainee.presenter.screen.instruction.text
    assert "Begin or end a stroke" in [hint.action for hint in trainee.presenter.screen.hints]
    draw_stroke(trainee)
    trainee.until(lambda: not trainee.state.training.trace.is_on, "the end of the stroke")
    trainee.step()
    count = traced(trainee)
    assert trainee.state.training.phase is Phase.COMPLETE
    assert trainee.presenter.screen.status[1] == f"{count} of 30–500 points traced"
    trainee.tap_until("menu", "trial")
    assert trainee.menu.paragraphs == (f"P07, {count} points are traced.",)
    trainee.choose("register", "match")
    trainee.until(lambda: "cannot be matched" in trainee.menu.paragraphs[0], "the reason")
    assert "are at the same place" in trainee.menu.paragraphs[0]
    assert not trainee.item("accept").is_enabled
    trainee.choose("draw", None)
    assert trainee.state.training.phase is Phase.COMPLETE
    register_matched(trainee)


def register_matched(trainee):
    """Accept a match that is known, of a trial whose trace can be registered."""
    matched = Future()
    session = trainee.presenter._session
    session.pages.show(match_page(session, matched))
    trainee.until_menu("match")
    assert not trainee.item("accept").is_enabled
    matched.set_result(known_match(0.97, 0.31, (0.05, 1.2)).result())
    trainee.until(lambda: trainee.item("accept").is_enabled, "the match")
    shown = [fact.value for fact in trainee.menu.facts]
    assert shown == ["0.42 mm", "97 %", "0.31 mm", "0.05 to 1.20 mm"]
    trainee.choose("accept")
    trainee.until(lambda: trainee.state.training.phase is Phase.REGISTERED, "the registration")


def test_the_method_is_chosen_in_the_experiment_menu_if_the_head_has_landmarks(trainee):
    trainee.go_to_experiment("P07")
    trainee.focus("method")
    seen = [trainee.item("method").value]
    for _ in range(2):
        trainee.tap("right")
        seen.append(trainee.item("method").value)
    assert seen == ["fiducials", "landmarks of the face", "trace over the skin"]
    session = trainee.presenter._session
    assert registration_method(session, "trial-run").value == "fiducials"
    start_task(session, "task-1")
    trainee.until_menu(None)
    training = trainee.state.training
    assert training.method.value == "surface"
    assert training.next_point == LANDMARKS[0].name


@pytest.fixture(scope="module")
def landmarked(setup):
    return with_landmarks(setup.scenario)


def drawn(scenario, where):
    """Return a trial with a trace over a part of the head, its residual small."""
    mesh, random = traces.colin27(), np.random.default_rng(5)
    places = traces.places(mesh, where)
    trace = traces.traced(mesh, places, random, scenario.head_to_world, 0.1, 60) / 1000.0
    touched = [
        transforms.apply(scenario.head_to_world, each.position_ras) for each in LANDMARKS[:3]
    ]
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
    seen = registration_so_far(trial, landmarked)
    values = {"task": "task-1", "method": "surface", **given(trial)}
    registered = register_trial(GivenPoints.of_answer(values), landmarked)
    assert seen.match.rms_mm == registered.rigid.fre_mm < 0.2
    at_target = seen.target_errors[RIGID]
    assert at_target.expected_mm == registered.arguments("x")["expectedTreMm"]
    assert at_target.interval_mm[0] < at_target.expected_mm < at_target.interval_mm[1]
    assert "slides" not in {warning.code for warning in seen.match.warnings}


def test_a_trace_on_the_crown_alone_is_reported_before_it_is_accepted(landmarked):
    match = registration_so_far(drawn(landmarked, "crown"), landmarked).match
    assert match.rms_mm < 0.2
    assert "slides" in {warning.code for warning in match.warnings}
    assert match.slide.distance_mm > 3.0
