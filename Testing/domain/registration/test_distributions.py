"""Quantiles of sums of squares agree with scipy's, and with simulation."""

import numpy as np
import pytest
import scipy.stats

from rastrainer.registration.distributions import ratio_quantile


@pytest.mark.parametrize("dof", [2, 3, 39, 2994])
def test_the_quantile_of_equally_weighted_squares_is_that_of_f(dof):
    for probability in (0.001, 0.025, 0.5, 0.975, 0.999):
        expected = 3 * scipy.stats.f.ppf(probability, 3, dof)
        ours = ratio_quantile(probability, np.ones(3), dof)
        assert ours == pytest.approx(expected, rel=1e-6)


def test_the_quantile_of_unequally_weighted_squares_agrees_with_simulation():
    rng = np.random.default_rng(0)
    weights = np.array([0.05, 1.0, 4.0])
    squares = (weights * rng.normal(size=(400_000, 3)) ** 2).sum(axis=1)
    ratios = squares / (rng.chisquare(6, 400_000) / 6)
    for probability in (0.025, 0.5, 0.975):
        share = np.mean(ratios <= ratio_quantile(probability, weights, 6))
        assert share == pytest.approx(probability, abs=0.002)
