"""The feed of drill and instrument in the guide."""

import pytest

from rastrainer.protocol import Phase
from rastrainer_simulator.state import NEUTRAL_STICKS, OperatorInput
from rastrainer_simulator.teleoperation.teleoperation import StickResponse
from rastrainer_simulator.training.feed import (
    LONGEST_FEED_M,
    Feed,
    FeedDrive,
    FeedLayer,
    HeadAhead,
    ProcedureSettings,
)

DT = 0.004
AHEAD = HeadAhead(skin=0.02, outer=0.027, inner=0.034)
DRILLING, INSERTING = Phase.DRILLING, Phase.INSERTING


@pytest.fixture
def drive():
    return FeedDrive(ProcedureSettings(), StickResponse())


def stick(up, fine=False):
    return OperatorInput(translation=(0.0, 0.0, up), fine=fine)


def test_a_commanded_feed_lasts_for_its_duration_within_the_limit_or_until_the_stick(drive):
    drive.start(50.0, 0.1)
    distances = [drive.way(DT, DRILLING, NEUTRAL_STICKS)[0] for _ in range(30)]
    assert sum(distances) == pytest.approx(0.005 * 0.1)
    assert distances[25:] == [0.0] * 5
    drive.start(-2.0, 0.01)
    assert sum(drive.way(DT, DRILLING, NEUTRAL_STICKS)[0] for _ in range(5)) == pytest.approx(-2e-5)
    drive.start(5.0, 2.0)
    assert drive.way(DT, DRILLING, stick(1.0))[0] < 0.0
    assert drive.way(DT, DRILLING, NEUTRAL_STICKS)[0] == 0.0


def test_the_drill_moves_from_the_guides_tip_to_its_full_length_and_its_depth_is_kept():
    feed = Feed(ahead=AHEAD)
    assert feed.moved(DRILLING, -0.01).depth == 0.0
    deep = feed.moved(DRILLING, 1.0)
    assert deep.depth == deep.drilled == LONGEST_FEED_M
    back = feed.moved(DRILLING, 0.03).moved(DRILLING, -0.02)
    assert (back.depth, back.drilled) == pytest.approx((0.01, 0.03))


def test_an_instrument_stops_at_bone_that_is_not_drilled_through_and_feels_blocked():
    for drilled, limit in ((0.001, 0.027), (0.030, 0.030), (0.034, LONGEST_FEED_M)):
        feed = Feed(drilled=drilled, ahead=AHEAD)
        assert feed.moved(INSERTING, 1.0).depth == limit
    feed = Feed(drilled=0.030, ahead=AHEAD)
    assert feed.moved(INSERTING, 0.02).layer(INSERTING) is FeedLayer.FREE
    assert feed.moved(INSERTING, 0.05).layer(INSERTING) is FeedLayer.BLOCKED
