"""What views receive of a trace: only what is new, but all of it when they join late."""

import threading
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.commands import CommandName
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.loop.timing import LoopStatistics
from rastrainer_simulator.presentation.messages import SkinPlace
from rastrainer_simulator.presentation.presenter import TraceGuidance
from rastrainer_simulator.state import StepResult
from Testing.simulator.landmarked import with_landmarks
from Testing.simulator.net.views.served import ServedViews
from Testing.simulator.training.hand_driven import Trial

PLACE = SkinPlace((1.0, 80.0, -20.0), (0.0, 1.0, 0.0))
GUIDED = TraceGuidance(10.0, PLACE)
NEXT = {"positionMm": [1.0, 80.0, -20.0], "normal": [0.0, 1.0, 0.0]}


class RepeatedStates:
    """A `StateSource` that repeats one state, until a test sets another."""

    statistics = LoopStatistics()

    def __init__(self, state, setup):
        self.latest, self.setup = state, setup
        self._callbacks = []
        self._has_ended = threading.Event()
        self._thread = threading.Thread(target=self._tell, daemon=True)
        self._thread.start()

    def subscribe(self, callback):
        self._callbacks.append(callback)
        return lambda: self._callbacks.remove(callback)

    def end(self):
        self._has_ended.set()
        self._thread.join()

    def _tell(self):
        while not self._has_ended.wait(0.005):
            for callback in tuple(self._callbacks):
                callback(StepResult(self.latest))


class TracedTrial:
    """A trial by surface whose tip is dragged by hand, and what views receive of it."""

    def __init__(self, control_loop, loop_thread):
        self.trial = Trial(with_landmarks(control_loop.setup.scenario))
        self.trial.start(method="surface")
        self.trial.touch(3)
        self._idle = control_loop.latest
        self.source = RepeatedStates(self._idle, control_loop.setup)
        self.served = ServedViews(loop_thread, self.source)

    def close(self):
        self.served.close()
        self.source.end()

    def news(self, view):
        """Send the trial as it stands; return the next message of its trace."""
        self.source.latest = replace(self._idle, training=self.trial.state)
        return view.next("trace")

    def draw(self, count, height):
        """Draw a stroke of a number of points at a height, m."""
        self.trial.must(CommandName.TRACE, on=True)
        for number in range(count):
            self.trial.now += 0.02
            self.trial.at((0.4 + 0.002 * number, 0.1, height))
        self.trial.must(CommandName.TRACE, on=False)

    def in_head(self, first):
        """Return the points from one on, in the head's frame, mm."""
        places = np.array([point.position for point in self.trial.state.trace.points[first:]])
        pose = self._idle.head_to_world
        return (MM_PER_M * (places - pose[:3, 3]) @ pose[:3, :3]).round(2).tolist()


@pytest.fixture
def traced(control_loop, loop_thread):
    traced = TracedTrial(control_loop, loop_thread)
    yield traced
    traced.close()


def test_views_are_sent_only_what_is_new_and_late_ones_the_whole_trace(traced, connect):
    view = connect(traced.served)
    view.join()
    traced.draw(5, 0.30)
    first = traced.news(view)
    assert (first["known"], first["coveredMm"], first["next"]) == (0, 0.0, None)
    assert first["points"] == traced.in_head(0)
    traced.draw(3, 0.32)
    second = traced.news(view)
    assert (second["known"], second["points"]) == (5, traced.in_head(5))
    late = connect(traced.served)
    late.join()
    message = late.next("trace")
    assert (message["known"], message["points"]) == (0, traced.in_head(0))


def test_an_undone_stroke_is_removed(traced, connect):
    view = connect(traced.served)
    view.join()
    for count, height in ((4, 0.30), (6, 0.32)):
        traced.draw(count, height)
        traced.news(view)
    traced.trial.must(CommandName.UNDO)
    assert traced.news(view)["points"] == []
    traced.draw(2, 0.34)
    last = traced.news(view)
    assert (last["known"], last["points"]) == (4, traced.in_head(4))


def test_guidance_comes_with_the_trace_and_disappears_when_the_trial_ends(traced, connect):
    traced.served.presenter.guidance = GUIDED
    view = connect(traced.served)
    view.join()
    message = traced.news(view)
    assert (message["points"], message["coveredMm"], message["next"]) == ([], 10.0, NEXT)
    traced.draw(30, 0.30)
    assert traced.news(view)["next"] == NEXT
    traced.trial.must(CommandName.REGISTER)
    last = traced.news(view)
    assert (last["known"], last["points"], last["coveredMm"], last["next"]) == (0, [], 0.0, None)
