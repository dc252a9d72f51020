"""Probabilities without scipy agree with scipy's."""

import numpy as np
import pytest
import scipy.stats

from rastrainer.distributions import f_tail, incomplete_beta


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
