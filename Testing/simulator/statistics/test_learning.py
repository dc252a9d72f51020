"""Learning curves and trends, against independent values and simulation."""

import itertools

import numpy as np
import pytest
import scipy.optimize
import scipy.stats

from rastrainer.errors import InputError
from rastrainer_simulator.statistics.trend import (
    TrendVerdict,
    cohort_trend_p,
    falling_trend,
    fit_learning_curve,
)


def test_a_learning_curve_is_scipys_least_squares():
    rng = np.random.default_rng(5)
    n = np.arange(1, 21)
    y = 80 * n**-0.8 + 60 + rng.normal(0, 4, 20)
    expected, _ = scipy.optimize.curve_fit(lambda x, a, b, c: a * x**-b + c, n, y, [50, 0.5, 50])
    curve = fit_learning_curve(y)
    np.testing.assert_allclose(curve.at(n), expected[0] * n ** -expected[1] + expected[2], atol=0.2)


def test_the_trend_is_tested_by_all_orders_of_the_values():
    values = np.array([131.0, 119.0, 125.0, 118.0, 112.0, 115.0])
    x = np.log(np.arange(1, 7))
    slopes = np.array([x @ np.array(order) for order in itertools.permutations(values)])
    trend = falling_trend(values)
    assert trend.p == pytest.approx(np.mean(slopes <= x @ values + 1e-9), rel=1e-9)
    line = scipy.stats.linregress(x, values)
    assert trend.change.value == pytest.approx(line.slope * x[-1], rel=1e-9)
    reach = scipy.stats.t.ppf(0.95, 4) * line.stderr * x[-1]
    np.testing.assert_allclose(
        trend.change.interval, trend.change.value + np.array([-reach, reach])
    )


def test_inconclusive_trials_are_undecided_and_constant_ones_steady():
    assert falling_trend([120.0, 119.0, 121.0, 120.5, 119.5]).verdict is TrendVerdict.STEADY
    assert falling_trend([120.0] * 5).verdict is TrendVerdict.STEADY
    assert falling_trend([140.0, 100.0, 150.0, 95.0, 125.0]).verdict is TrendVerdict.UNDECIDED
    assert falling_trend([100.0, 110.0, 120.0, 130.0, 140.0]).verdict is TrendVerdict.UNDECIDED
    with pytest.raises(InputError, match="from 4 finite values on"):
        falling_trend([3.0, 2.0, 1.0])


def test_the_trend_of_all_trainees_is_pages():
    """Page 1963: L of his ordered hypothesis; here against scipy on the reversed columns."""
    rows = np.random.default_rng(4).normal(0, 1, (6, 5)) - 0.4 * np.arange(5)
    expected = scipy.stats.page_trend_test(rows[:, ::-1]).pvalue
    assert cohort_trend_p(rows) == pytest.approx(expected, rel=1e-9)
    with pytest.raises(InputError, match="at least two trainees"):
        cohort_trend_p(rows[:1])
