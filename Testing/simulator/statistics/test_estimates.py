"""Intervals of variances and of their differences hold the truth as often as they say."""

import numpy as np
import pytest
import scipy.stats

from rastrainer_simulator.statistics.intervals import (
    Estimate,
    MeanSquare,
    coefficient,
    difference,
    mean,
    variance,
)
from Testing.error_rates.measured import holds


def test_the_interval_of_a_mean_is_that_of_the_t_test():
    values = np.random.default_rng(1).normal(3.0, 2.0, 9)
    expected = scipy.stats.ttest_1samp(values, 0.0).confidence_interval(0.95)
    assert mean(values).interval == pytest.approx((expected.low, expected.high), abs=1e-12)


def test_the_interval_of_a_variance_has_2_5_percent_on_each_side():
    found = variance(MeanSquare(4.0, 7))
    tails = [scipy.stats.chi2.cdf(7 * 4.0 / limit, 7) for limit in found.interval]
    assert tails == pytest.approx([0.975, 0.025], abs=1e-12)


@pytest.mark.parametrize(("dof", "other_dof"), [(3, 8), (11, 11), (11, 90), (40, 4)])
def test_the_interval_of_a_difference_has_a_bound_at_0_at_the_limit_of_the_f_test(dof, other_dof):
    ratio = scipy.stats.f.isf(0.025, dof, other_dof)
    low, _ = difference(MeanSquare(ratio, dof), MeanSquare(1.0, other_dof)).interval
    assert low == pytest.approx(0.0, abs=1e-9)
    ratio = scipy.stats.f.isf(0.975, dof, other_dof)
    _, high = difference(MeanSquare(ratio, dof), MeanSquare(1.0, other_dof)).interval
    assert high == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("ratio", [1.0, 4.0])
@pytest.mark.parametrize(("dof", "other_dof"), [(3, 3), (11, 90)])
def test_the_interval_of_a_difference_contains_it_in_95_of_100_cases(dof, other_dof, ratio):
    random = np.random.default_rng([dof, other_dof, int(10 * ratio)])
    squares = zip(
        ratio * random.chisquare(dof, 2000) / dof,
        random.chisquare(other_dof, 2000) / other_dof,
        strict=True,
    )
    held = [
        holds(difference(MeanSquare(one, dof), MeanSquare(other, other_dof)).interval, ratio - 1.0)
        for one, other in squares
    ]
    # Three standard errors of 2000 cases are 1.5 %.
    assert 0.935 <= np.mean(held) <= 0.98


def test_an_estimate_is_mapped_with_its_interval_and_may_be_certain():
    mapped = Estimate(1.0, (-0.5, 2.0)).mapped(lambda value: 10.0 * value)
    assert mapped == Estimate(10.0, (-5.0, 20.0))
    assert coefficient(1.0, 0.0, 5).interval == (1.0, 1.0)
