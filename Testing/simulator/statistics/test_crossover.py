"""The effects of the period and of the mode are separated."""

import itertools

import numpy as np
import pytest
import scipy.stats

from rastrainer.errors import InputError
from rastrainer_simulator.statistics import paired

rng = np.random.default_rng(8)
ORDERS = {
    "balanced": np.tile([1.0, -1.0], 6),
    "unbalanced": np.repeat([1.0, -1.0], [7, 4]),
    "one alone": np.repeat([1.0, -1.0], [4, 1]),
}


@pytest.fixture(params=ORDERS.values(), ids=ORDERS)
def study(request):
    """Values of two conditions, 6 apart, with 10 more in the later period, and the order."""
    order = request.param
    first = rng.normal(100, 20, len(order)) - 5 * order
    return first, first + 6 + 10 * order + rng.normal(0, 6, len(order)), order


def test_the_test_of_the_conditions_is_the_two_sample_t_test_of_later_minus_earlier(study):
    """Hills and Armitage 1979: half the difference of the sequences' mean period differences."""
    first, second, order = study
    found = paired.compare_paired(first, second, order)
    later_minus_earlier = (second - first) * order
    groups = later_minus_earlier[order > 0], later_minus_earlier[order < 0]
    expected = scipy.stats.ttest_ind(*groups)
    assert found.t == pytest.approx(expected.statistic, rel=1e-9)
    assert found.p == pytest.approx(expected.pvalue, rel=1e-9)
    assert found.dof == len(order) - 2
    limits = np.array(expected.confidence_interval(0.95)) / 2
    np.testing.assert_allclose(found.difference.interval, limits, rtol=1e-9)


def test_difference_and_period_are_statsmodels_model_of_subject_mode_and_period():
    """Numbers of statsmodels 0.15.0, `smf.ols("y ~ C(subject) + mode + period", rows).fit()`.

    A row is a value of a subject in a mode; mode is 1 for the headset, period 1 for the later one.
    """
    desktop = np.array([112.3, 98.1, 130.4, 121.7, 105.2, 117.9, 126.0])
    hmd = np.array([109.8, 111.5, 121.9, 138.2, 101.3, 129.4, 140.1])
    found = paired.compare_paired(desktop, hmd, np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0, -1.0]))
    assert found.difference.value == pytest.approx(4.454166666666698, rel=1e-9)
    assert found.standard_error == pytest.approx(0.9738222944208613, rel=1e-9)
    assert found.t == pytest.approx(4.573900897715245, rel=1e-9)
    assert found.p == pytest.approx(0.005980599705023075, rel=1e-9)
    limits = 1.9508767654907522, 6.957456567842643
    np.testing.assert_allclose(found.difference.interval, limits, rtol=1e-9)
    assert found.sequences.later.value == pytest.approx(-9.420833333333334, rel=1e-9)
    limits = -11.924123234509281, -6.917543432157388
    np.testing.assert_allclose(found.sequences.later.interval, limits, rtol=1e-9)


def test_orders_in_which_modes_alternate_are_regressed_the_same_way():
    order = np.array([1.0, -1.0, 0.0, 2.0, -2.0, 1.0, 0.0])
    differences = rng.normal(3, 1, (5, 7))
    found = paired.fit_differences(differences, order)
    for row, mean, error in zip(differences, found.mean, found.standard_error, strict=True):
        expected = scipy.stats.linregress(order, row)
        assert (mean, error) == (
            pytest.approx(expected.intercept, rel=1e-9),
            pytest.approx(expected.intercept_stderr, rel=1e-9),
        )
    assert paired.compare_paired(np.zeros(7), differences[0], order).ranks is None


def test_sequences_are_compared_by_their_means_over_both_conditions():
    order = ORDERS["unbalanced"]
    first, second = rng.normal(100, 10, (2, 11))
    found = paired.compare_paired(first, second, order).sequences
    means = (first + second) / 2
    expected = scipy.stats.ttest_ind(means[order < 0], means[order > 0])
    assert (found.first_first, found.second_first) == (7, 4)
    assert found.between.value == pytest.approx(means[order < 0].mean() - means[order > 0].mean())
    limits = expected.confidence_interval(0.95)
    np.testing.assert_allclose(found.between.interval, (limits.low, limits.high), rtol=1e-9)
    alone = paired.compare_paired(first[:5], second[:5], ORDERS["one alone"]).sequences
    assert alone.between is None


@pytest.mark.parametrize(
    "order",
    [None, np.ones(6), np.array([1.0, 2.0, 2.0, 1.0]), np.array([1.0, -1.0, 1.0])],
    ids=["unknown", "the same for all", "never the other way round", "too few"],
)
def test_without_different_orders_a_paired_t_test_is_used(order):
    n = 6 if order is None else len(order)
    values = rng.normal(1, 1, n)
    found = paired.compare_paired(np.zeros(n), values, order)
    assert not paired.is_separable(order)
    assert found.sequences is None
    assert found.p == pytest.approx(scipy.stats.ttest_1samp(values, 0.0).pvalue, rel=1e-9)


def test_differences_explained_by_the_period_cannot_be_tested():
    order = ORDERS["balanced"]
    with pytest.raises(InputError, match="by the same amount"):
        paired.compare_paired(np.zeros(12), 3.0 + 2.0 * order, order)


def test_the_rank_sum_test_is_scipys_exact_one_and_stays_exact_with_ties():
    one, other = rng.normal(0.6, 1, 6), rng.normal(0, 1, 8)
    expected = scipy.stats.mannwhitneyu(one, other, method="exact")
    found = paired.rank_sum_test(one, other)
    assert found.p == pytest.approx(expected.pvalue, rel=1e-9)
    tied = np.array([1.0, 1.0, 2.0, 3.0, 3.0, 3.0, 4.0])
    ranks = scipy.stats.rankdata(tied)
    sums = np.array([sum(ranks[list(rows)]) for rows in itertools.combinations(range(7), 3)])
    observed = ranks[:3].sum()
    by_hand = 2 * min(np.mean(sums <= observed), np.mean(sums >= observed))
    assert paired.rank_sum_test(tied[:3], tied[3:]).p == pytest.approx(by_hand, rel=1e-9)
    assert paired.rank_sum_test(np.arange(2.0), np.arange(5.0, 7.0)).smallest_p == pytest.approx(
        1 / 3
    )
    assert paired.rank_sum_test(one, np.zeros(0)) is None
    many = rng.normal(size=(2, 80))
    asymptotic = scipy.stats.mannwhitneyu(*many, method="asymptotic").pvalue
    assert paired.rank_sum_test(*many).p == pytest.approx(asymptotic, rel=1e-9)
