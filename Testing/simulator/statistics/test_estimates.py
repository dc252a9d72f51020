"""Intervals of variances and of their differences hold the truth as often as they say."""

import numpy as np
import pytest
import scipy.stats

from rastrainer_simulator.statistics.intervals import (
    MeanSquare,
    difference,
    mean,
    variance,
)


def test_the_interval_of_a_mean_is_that_of_the_t_test():
    values = np.random.default_rng(1).normal(3.0, 2.0, 9)
    expected = scipy.stats.ttest_1samp(values, 0.0).confidence_interval(0.95)
    assert mean(values).interval == pytest.approx((expected.low, expected.high), abs=1e-12)


def test_the_interval_of_a_variance_has_2_5_percent_on_each_side():
    found = variance(MeanSquare(4.0, 7))
    tails = [scipy.stats.chi2.cdf(7 * 4.0 / limit, 7) for limit in found.interval]
    assert tails == pytest.approx([0.975, 0.025], abs=1e-12)


@pytest.mark.parametrize(("dof", "other_dof"), [(3, 8), (11, 90)])
def test_the_interval_of_a_difference_has_a_bound_at_0_at_the_limit_of_the_f_test(dof, other_dof):
    ratio = scipy.stats.f.isf(0.025, dof, other_dof)
    low, _ = difference(MeanSquare(ratio, dof), MeanSquare(1.0, other_dof)).interval
    assert low == pytest.approx(0.0, abs=1e-9)
    ratio = scipy.stats.f.isf(0.975, dof, other_dof)
    _, high = difference(MeanSquare(ratio, dof), MeanSquare(1.0, other_dof)).interval
    assert high == pytest.approx(0.0, abs=1e-9)
