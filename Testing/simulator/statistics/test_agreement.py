"""Agreement of raters: published and independent values, and what cannot be computed."""

import numpy as np
import pytest
import scipy.stats

from rastrainer.errors import InputError
from rastrainer_simulator.statistics.agreement import (
    intraclass_correlations,
    kappa_of_table,
    quadratic_kappa,
)

# Six targets by four judges: Shrout and Fleiss 1979, table 2.
SHROUT_FLEISS = np.array(
    [[9, 2, 5, 8], [6, 1, 3, 2], [8, 4, 6, 8], [7, 1, 2, 6], [10, 5, 6, 9], [6, 2, 4, 7]]
)
FIRST = [3, 2, 5, 4, 1, 3, 3, 4, 5, 2, 4, 3, 2, 5, 1, 3]
SECOND = [3, 3, 5, 4, 2, 3, 4, 4, 4, 2, 5, 3, 1, 5, 2, 2]


def test_the_coefficients_are_the_published_ones_of_shrout_and_fleiss():
    found = intraclass_correlations(SHROUT_FLEISS)
    assert (found.objects, found.raters) == (6, 4)
    assert found.single.value == pytest.approx(0.29, abs=0.005)
    assert found.average.value == pytest.approx(0.62, abs=0.005)


def test_the_intervals_are_quantiles_of_the_variances_that_the_ratings_allow():
    n, k = SHROUT_FLEISS.shape
    effects = sums_of_squares(SHROUT_FLEISS)
    even = scipy.stats.qmc.Sobol(3, seed=5).random(2**14)
    dofs = np.array([n - 1, k - 1, (n - 1) * (k - 1)])
    objects, raters, error = (effects / scipy.stats.chi2.ppf(even, dofs)).T
    of_objects, of_raters = (objects - error) / k, (raters - error) / n
    allowed = of_objects / (of_objects + of_raters + error)
    found = intraclass_correlations(SHROUT_FLEISS)
    assert found.single.interval == pytest.approx(np.quantile(allowed, [0.025, 0.975]), abs=0.015)
    of_mean = k * np.array(found.single.interval) / (1 + (k - 1) * np.array(found.single.interval))
    assert found.average.interval == pytest.approx(of_mean)


def sums_of_squares(ratings):
    """The standard deviations of objects, raters and rest."""
    mean = ratings.mean()
    objects, raters = ratings.mean(axis=1) - mean, ratings.mean(axis=0) - mean
    rest = ratings - mean - objects[:, None] - raters
    n, k = ratings.shape
    sums = np.array([k * objects @ objects, n * raters @ raters, np.sum(rest**2)])
    assert sums.sum() == pytest.approx(np.sum((ratings - mean) ** 2))
    return sums


def test_a_rater_who_is_always_more_lenient_agrees_less_and_has_no_interval():
    quality = np.arange(6.0)
    found = intraclass_correlations(np.column_stack([quality, quality + 2.0]))
    assert found.single.value == pytest.approx(3.5 / (3.5 + 2.0))
    assert (found.single.interval, found.average.interval) == (None, None)
    assert intraclass_correlations(np.column_stack([quality, quality])).single.value == 1.0


def test_too_few_or_equal_ratings_are_refused_with_a_message():
    for ratings, sentence in (
        ([[1, 2], [2, 3]], "the same three objects"),
        ([[1, 2], [1, 2], [1, 2]], "all objects were rated the same"),
    ):
        with pytest.raises(InputError, match=sentence):
            intraclass_correlations(np.array(ratings))
    with pytest.raises(InputError, match="every object the same mark"):
        quadratic_kappa([4, 4, 4, 4], [4, 4, 4, 4], 1, 5)


def test_a_weighted_kappa_is_the_published_one():
    # Cohen 1968, 200 patients, with the disagreements 0, 1, 3 and 6.
    cohen = np.array([[0.44, 0.07, 0.09], [0.05, 0.20, 0.05], [0.01, 0.03, 0.06]])
    weights = 1.0 - np.array([[0, 1, 3], [1, 0, 6], [3, 6, 0]]) / 6.0
    assert kappa_of_table(cohen, np.eye(3)) == pytest.approx(0.492, abs=5e-4)
    assert kappa_of_table(cohen, weights) == pytest.approx(0.348, abs=5e-4)
    # Fleiss, Cohen and Everitt 1969.
    fleiss = np.array([[0.53, 0.05, 0.02], [0.11, 0.14, 0.05], [0.01, 0.06, 0.03]])
    weights = np.array([[1, 0, 0.4444], [0, 1, 0.6667], [0.4444, 0.6667, 1]])
    assert kappa_of_table(fleiss, np.eye(3)) == pytest.approx(0.429, abs=5e-4)
    assert kappa_of_table(fleiss, weights) == pytest.approx(0.507, abs=5e-4)
