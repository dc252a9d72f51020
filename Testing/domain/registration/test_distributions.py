"""Probabilities without scipy agree with scipy's."""

import numpy as np
import pytest
import scipy.stats

from rastrainer.registration.distributions import _quantile, f_tail, incomplete_beta, ratio_quantile


def test_the_tail_of_f_agrees_with_scipy_down_to_the_smallest_probabilities():
    for numerator in (1, 3, 6, 50):
        for denominator in (1, 2, 3, 39, 300, 2994):
            for value in (0.0, 1e-3, 0.5, 1.0, 4.0, 30.0, 1e4):
                expected = scipy.stats.f.sf(value, numerator, denominator)
                assert f_tail(value, numerator, denominator) == pytest.approx(expected, rel=1e-8)
    assert f_tail(np.inf, 3, 10) == 0.0


def test_the_incomplete_beta_function_agrees_with_scipy():
    rng = np.random.default_rng(0)
    for a, b, x in zip(*rng.uniform(0.5, 60, (2, 200)), rng.uniform(0, 1, 200), strict=True):
        assert incomplete_beta(a, b, x) == pytest.approx(scipy.special.betainc(a, b, x), abs=1e-12)


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


def test_the_quantile_of_a_step_distribution_is_its_step():
    assert _quantile(lambda value: float(value >= 2.0), 0.5, 1.0, 1e-8) == pytest.approx(2.0)
