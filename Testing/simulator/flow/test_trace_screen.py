"""A trace by the trainee's own controls: the touch control begins and ends a stroke."""

from dataclasses import replace

import pytest

from rastrainer.protocol import MIN_TRACE_POINTS, Phase
from rastrainer_simulator.core.simulation import Simulation
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


def test_landmarks_are_touched_and_strokes_begun_ended_and_registered_by_the_controls(trainee):
    start = {"task": "task-1", "trainee": "P07", "method": "surface"}
    assert trainee.submit("StartTask", **start).ok
    trainee.until_menu(None)
    for number, landmark in enumerate(LANDMARKS[:3]):
        assert landmark.name in trainee.presenter.screen.instruction.text
        assert trainee.presenter.screen.status[1] == f"{number} of 3 points"
        trainee.tap("touch")
        trainee.until(lambda number=number: trainee.touched > number, "the touch")
        trainee.step()
    assert trainee.presenter.screen.status[1] == "0 of 500 points traced"
    assert "draw the tip over the skin" in trainee.presenter.screen.instruction.text
    assert "Begin or end a stroke" in [hint.action for hint in trainee.presenter.screen.hints]
    trainee.tap("touch")
    trainee.until(lambda: trainee.state.training.trace.is_on, "a stroke")
    trainee.hands.push(0.9, 0.0, 0.0, fine=False)
    trainee.until(lambda: traced(trainee) > MIN_TRACE_POINTS, "the points")
    trainee.hands.push(0.0, 0.0, 0.0, fine=False)
    trainee.tap("touch")
    trainee.until(lambda: not trainee.state.training.trace.is_on, "the end of the stroke")
    trainee.step()
    count = traced(trainee)
    assert trainee.state.training.phase is Phase.COMPLETE
    assert trainee.presenter.screen.status[1] == f"{count} of 500 points traced"
    trainee.tap("menu")
    trainee.until_menu("trial")
    trainee.choose("register")
    trainee.until(lambda: trainee.state.training.phase is not Phase.COMPLETE, "the registration")
    assert trainee.state.training.phase is Phase.REGISTERED
