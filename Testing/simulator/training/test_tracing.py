"""A trial registered by landmarks or by a trace: touches, strokes, undoing, and instructions."""

from dataclasses import replace

import pytest

from rastrainer.commands import CommandName
from rastrainer.protocol import MAX_TRACE_POINTS, Phase, RegistrationMethod
from Testing.simulator.landmarked import LANDMARKS, with_landmarks
from Testing.simulator.training.hand_driven import Trial

NAMES = [landmark.name for landmark in LANDMARKS]


@pytest.fixture
def landmarked(scenario):
    return with_landmarks(scenario)


def begun(scenario, method="surface", **others):
    trial = Trial(scenario)
    reply = trial.start(method=method, **others)
    assert reply.ok, reply.message
    return trial


def traced(scenario, count, method="surface", **others):
    """Return a trial with one ended stroke of a number of points."""
    trial = begun(scenario, method, **others)
    trial.touch(3 if method == "surface" else len(NAMES))
    stroke(trial, count)
    return trial


def stroke(trial, count, first=0):
    trial.must(CommandName.TRACE, on=True)
    drag(trial, count, first)
    if trial.state.trace.is_on:
        trial.must(CommandName.TRACE, on=False)


def drag(trial, count, first=0, above_mm=0.0, spacing_mm=1.01):
    """Draw the tip along a line; return the events."""
    events = []
    for number in range(first, first + count):
        trial.now += 0.02
        events += trial.at((0.001 * spacing_mm * number, 0.2, 0.3), above_mm)
    return events


def test_landmarks_are_touched_by_name_in_order_with_a_radius_of_their_own(landmarked):
    trial = begun(landmarked, "landmarks")
    assert trial.state.method is RegistrationMethod.LANDMARKS
    for number, name in enumerate(NAMES):
        assert trial.state.next_point == name
        x, y, z = trial.fiducial(name)
        assert trial.do(CommandName.CAPTURE, (x + 0.021, y, z)).ok is False
        assert trial.do(CommandName.CAPTURE, (x, y, z), above_mm=3.0).ok is False
        assert trial.must(CommandName.CAPTURE, (x + 0.019, y, z)).data["kept"] == number + 1
    assert trial.state.phase is Phase.COMPLETE
    assert trial.must(CommandName.REGISTER).data["method"] == "landmarks"


def test_a_surface_trial_touches_three_landmarks_and_then_waits_for_the_trace(landmarked):
    trial = begun(landmarked)
    early = trial.do(CommandName.TRACE, on=True)
    assert early.message == "0 of 3 landmarks are touched: touch point Nasion before tracing."
    trial.touch(3)
    assert (trial.state.phase, trial.state.next_point) == (Phase.RUNNING, None)
    assert "trace the skin with the tip" in trial.state.instruction
    assert "trace the skin now" in trial.do(CommandName.CAPTURE, (0, 0, 0)).message
    assert "0 points are traced, and registering needs 30" in trial.do(CommandName.REGISTER).message


def test_the_tip_leaves_a_point_every_millimeter_and_only_on_the_skin(landmarked):
    trial = begun(landmarked)
    trial.touch(3)
    trial.must(CommandName.TRACE, on=True)
    assert len(drag(trial, 10, spacing_mm=0.26)) == 3
    assert drag(trial, 10, first=100, above_mm=0.6) == []
    assert trial.at((0.5, 0.2, 0.3), depth_mm=0.6) == ()
    assert len(drag(trial, 3, first=100, above_mm=0.4)) == 3
    trial.must(CommandName.TRACE, on=False)
    assert drag(trial, 5, first=200) == []
    assert len(trial.state.trace.points) == 6


def test_the_five_hundredth_point_ends_the_stroke_and_no_more_are_accepted(landmarked):
    trial = traced(landmarked, MAX_TRACE_POINTS + 5)
    assert len(trial.state.trace.points) == MAX_TRACE_POINTS
    assert trial.state.phase is Phase.COMPLETE
    assert "the most a trial can have" in trial.state.instruction
    assert "the most a trial can have" in trial.do(CommandName.TRACE, on=True).message
    trial.must(CommandName.UNDO)
    assert trial.must(CommandName.TRACE, on=True).ok


def test_undo_removes_the_last_stroke_and_then_the_last_landmark(landmarked):
    trial = traced(landmarked, 40)
    stroke(trial, 12, first=100)
    assert trial.must(CommandName.UNDO).data == {
        "on": False,
        "kept": 40,
        "strokes": 1,
        "undone": True,
    }
    assert trial.state.phase is Phase.COMPLETE
    trial.must(CommandName.UNDO)
    assert (trial.state.phase, trial.state.trace.points) == (Phase.RUNNING, ())
    assert trial.must(CommandName.UNDO).data["label"] == NAMES[2]
    assert trial.state.next_point == NAMES[2]


@pytest.mark.parametrize(
    ("method", "said"),
    [
        ("laser", "methods are fiducials, landmarks, surface, landmarks-surface"),
        ("surface", "has 0 landmarks"),
    ],
)
def test_a_method_the_scenario_does_not_support_is_refused_with_the_reason(scenario, method, said):
    reply = Trial(replace(scenario, landmarks=())).start(method=method)
    assert not reply.ok
    assert said in reply.message
