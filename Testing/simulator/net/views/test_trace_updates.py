"""Views receive only the new part of a trace, but the whole trace if they join late."""

import numpy as np
import pytest

from rastrainer.commands import CommandName
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.net.views.outgoing import TraceUpdate
from rastrainer_simulator.presentation.messages import SkinPlace, TraceNews
from rastrainer_simulator.presentation.presenter import TraceGuidance
from Testing.simulator.landmarked import with_landmarks
from Testing.simulator.net.igtl.servers import at_rest
from Testing.simulator.training.hand_driven import Trial

PLACE = SkinPlace((1.0, 80.0, -20.0), (0.0, 1.0, 0.0))
POSE = np.array([[0, -1, 0, 0.5], [1, 0, 0, -0.25], [0, 0, 1, 0.125], [0, 0, 0, 1]])


class TracedTrial(Trial):
    """A trial by surface whose tip is dragged by hand, and its messages to views."""

    def __init__(self, scenario):
        super().__init__(with_landmarks(scenario))
        self.start(method="surface")
        self.touch(3)
        self.update = TraceUpdate()

    def news(self, guidance=TraceGuidance(), after_s=1.0):  # noqa: B008
        """Return the message about the trial as it stands, some time after the last one."""
        self.now += after_s
        state = at_rest(training=self.state, head_to_world=POSE)
        return self.update.news(state, guidance, self.now)

    def draw(self, count, height):
        """Draw a stroke of a number of points at a height, m."""
        self.must(CommandName.TRACE, on=True)
        for number in range(count):
            self.now += 0.02
            self.at((0.4 + 0.002 * number, 0.1, height))
        self.must(CommandName.TRACE, on=False)

    def in_head(self, first=0):
        """Return points from `first` on, in the head's frame, mm."""
        places = np.array([point.position for point in self.state.trace.points[first:]])
        points = (MM_PER_M * (places - POSE[:3, 3]) @ POSE[:3, :3]).round(2)
        return tuple(map(tuple, points.tolist()))


@pytest.fixture
def traced(scenario):
    return TracedTrial(scenario)


def test_views_are_sent_only_what_is_new_and_late_ones_the_whole_trace(traced):
    assert traced.news() is None
    traced.draw(5, 0.30)
    assert traced.news() == TraceNews(0, traced.in_head(), 0.0, None)
    traced.draw(3, 0.32)
    assert traced.news(after_s=0.01) is None, "a view draws no faster"
    assert traced.news() == TraceNews(5, traced.in_head(5), 0.0, None)
    assert traced.update.everything() == TraceNews(0, traced.in_head(), 0.0, None)


def test_an_undone_stroke_is_removed(traced):
    for count, height in ((4, 0.30), (6, 0.32)):
        traced.draw(count, height)
        traced.news()
    traced.must(CommandName.UNDO)
    assert traced.news() == TraceNews(4, (), 0.0, None)
    traced.draw(2, 0.34)
    assert traced.news() == TraceNews(4, traced.in_head(4), 0.0, None)


def test_guidance_comes_with_the_trace_and_disappears_when_the_trial_ends(traced):
    guided = TraceGuidance(10.0, PLACE)
    assert traced.news(guided) == TraceNews(0, (), 10.0, PLACE)
    traced.draw(30, 0.30)
    assert traced.news(guided) == TraceNews(0, traced.in_head(), 10.0, PLACE)
    traced.must(CommandName.REGISTER)
    assert traced.news(guided) == TraceNews(0, (), 0.0, None)
