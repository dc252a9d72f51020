"""The bench's numbers about the control loop belong to the right seconds."""

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


def test_only_undisturbed_seconds_count():
    result = undisturbed(HEALTHS, lambda start, _end: start > 10.0)
    assert result.ticks == 500
    assert result.on_time == pytest.approx((250 - 1 + 240 - 4) / 500)
    np.testing.assert_allclose(result.shares, [99.6, 100 * 236 / 250])


def test_without_an_undisturbed_second_there_is_no_result():
    assert undisturbed(HEALTHS, lambda _start, _end: False) is None
