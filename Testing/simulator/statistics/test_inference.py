"""Tests, intervals and effect sizes agree with scipy's and with published values."""

import numpy as np
import pytest
import scipy.stats

from rastrainer.errors import InputError
from rastrainer_simulator.statistics import intervals, paired

rng = np.random.default_rng(3)
SAMPLES = [rng.normal(0.4, 1.0, n) for n in (3, 4, 5, 8, 12, 25, 60)]
DARWIN = np.array([49, -67, 8, 16, 6, 23, 28, 41, 14, 29, 56, 24, 75, 60, -48]) / 8
"""Darwin's fifteen pairs of maize, inches (Fisher 1935, The Design of Experiments, chapter 3)."""


@pytest.mark.parametrize(("t", "dof"), [(2.4, 7), (0.0, 3), (-3.0, 1), (40.0, 3), (6.0, 200)])
def test_the_interval_of_the_noncentrality_puts_t_at_its_tails(t, dof):
    low, high = intervals.noncentrality_interval(t, dof)
    assert scipy.stats.nct.cdf(t, dof, low) == pytest.approx(0.975, abs=1e-9)
    assert scipy.stats.nct.cdf(t, dof, high) == pytest.approx(0.025, abs=1e-9)


def test_darwins_maize_gives_fishers_t():
    comparison = paired.compare_paired(np.zeros(15), DARWIN)
    assert comparison.t == pytest.approx(2.148, abs=5e-4)
    assert comparison.difference.value * 8 == pytest.approx(20.933, abs=5e-4)


@pytest.mark.parametrize("values", SAMPLES, ids=len)
def test_the_signed_rank_test_agrees_with_scipys_exact_one(values):
    result = paired.signed_rank_test(values)
    expected = scipy.stats.wilcoxon(values, method="exact")
    assert result.p == pytest.approx(expected.pvalue, rel=1e-9)


def test_ties_and_zeros_keep_the_signed_rank_test_exact():
    values = np.array([0.0, 1.0, 1.0, -1.0, 2.0, 2.0, 3.0, -3.0, 4.0])
    signs = np.array(np.meshgrid(*[[-1, 1]] * 8)).reshape(8, -1)
    ranks = scipy.stats.rankdata(np.abs(values[1:]))
    sums = (ranks[:, None] * (signs > 0)).sum(axis=0)
    observed = ranks[values[1:] > 0].sum()
    expected = 2 * min(np.mean(sums <= observed), np.mean(sums >= observed))
    result = paired.signed_rank_test(values)
    assert result.p == pytest.approx(min(1.0, expected))


def test_hedges_factor_is_the_tabulated_one():
    """Hedges 1981, table 2: c(2) = .5642, c(3) = .7236, c(10) = .9228, c(50) = .9849."""
    for dof, expected in [(2, 0.5642), (3, 0.7236), (10, 0.9228), (50, 0.9849)]:
        assert intervals.small_sample_factor(dof) == pytest.approx(expected, abs=6e-5)


def test_at_the_margin_of_equivalence_the_larger_of_two_one_sided_tests_has_5_percent():
    values = SAMPLES[5]
    margin = paired.equivalence_margin(paired.compare_paired(np.zeros(25), values))
    above = scipy.stats.ttest_1samp(values, -margin, alternative="greater").pvalue
    below = scipy.stats.ttest_1samp(values, margin, alternative="less").pvalue
    assert max(above, below) == pytest.approx(0.05, rel=1e-9)


def test_power_is_that_of_the_tables():
    """Cohen 1988 / G*Power: d_z 0.5 needs 34 pairs, 0.2 needs 199, 0.8 needs 15 (power .80)."""
    assert [intervals.subjects_needed(size) for size in (0.2, 0.5, 0.8)] == [199, 34, 15]
    assert intervals.paired_power(0.5, 34) == pytest.approx(0.8078, abs=5e-4)
    assert intervals.paired_power(0.0, 12) == pytest.approx(0.05, abs=1e-9)
    assert intervals.paired_power(intervals.detectable_effect(4), 4) == pytest.approx(0.8, abs=1e-9)
    # A period costs a degree of freedom, and no more.
    assert intervals.paired_power(0.5, 34, with_period=True) == pytest.approx(0.8070, abs=5e-4)
    assert intervals.subjects_needed(0.8, with_period=True) == 15
    with pytest.raises(InputError, match="more than 10000 subjects"):
        intervals.subjects_needed(0.001)


def test_power_and_holms_correction_are_those_of_statsmodels():
    """statsmodels 0.15.0: `TTestPower().power(effect, n, 0.05)`, `multipletests(p, "holm")`."""
    expected = {
        (0.5, 34): 0.8077775012792737,
        (0.8, 12): 0.7136600656001074,
        (1.2, 8): 0.8279200603832425,
        (0.2, 199): 0.8016910240370655,
    }
    for (effect, n), power in expected.items():
        assert intervals.paired_power(effect, n) == pytest.approx(power, abs=1e-9)
        assert intervals.paired_power(-effect, n) == pytest.approx(power, abs=1e-9)
    adjusted = paired.holm([0.012, 0.034, 0.021, 0.4, 0.0009])
    np.testing.assert_allclose(adjusted, [0.048, 0.068, 0.063, 0.4, 0.0045], rtol=1e-9)


def test_a_correlation_has_scipys_p_and_fishers_interval():
    x, y = rng.normal(size=(2, 12))
    ours, theirs = intervals.correlation(x, y + x), scipy.stats.pearsonr(x, y + x)
    assert (ours.r, ours.p) == (pytest.approx(theirs.statistic), pytest.approx(theirs.pvalue))
    interval = theirs.confidence_interval(0.95)
    np.testing.assert_allclose(ours.interval, [interval.low, interval.high], rtol=1e-9)
    assert intervals.correlation([1, 2, 3], [1, 2, 4]).interval is None


def test_incomparable_values_are_refused():
    with pytest.raises(InputError, match="by the same amount"):
        paired.compare_paired(np.array([1.0, 2.0]), np.array([2.0, 3.0]))
