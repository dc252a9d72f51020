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
