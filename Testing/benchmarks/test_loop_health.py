"""What the bench says of the control loop is said of the right seconds."""

import numpy as np
import pytest

from rastrainer_simulator.loop.timing import LoopStatistics
from Testing.benchmarks.loop_health import undisturbed

HEALTHS = [
    (10.0, LoopStatistics(ticks=1000)),
    (11.0, LoopStatistics(ticks=1250, late=100)),
    (12.0, LoopStatistics(ticks=1500, late=101)),
    (12.1, LoopStatistics(ticks=1500, late=101)),
    (13.0, LoopStatistics(ticks=1740, late=105, skipped=10)),
]


def test_only_seconds_count_in_which_the_machine_took_nothing_away():
    result = undisturbed(HEALTHS, lambda start, _end: start > 10.0)
    assert result.ticks == 500
    assert result.on_time == pytest.approx((250 - 1 + 240 - 4) / 500)
    np.testing.assert_allclose(result.shares, [99.6, 100 * 236 / 250])


def test_where_there_is_no_such_second_nothing_is_said():
    assert undisturbed(HEALTHS, lambda _start, _end: False) is None
