"""Tests, intervals and effect sizes agree with scipy's and with published values."""

import math

import numpy as np
import pytest
import scipy.stats

from rastrainer.errors import InputError
from rastrainer.inference.correlation import correlation
from rastrainer.inference.few_subjects import what_cannot_be_concluded, what_it_shows
from rastrainer.inference.paired import (
    compare_paired,
    equivalence_margin,
    holm,
    small_sample_factor,
)
from rastrainer.inference.power import detectable_effect, paired_power, subjects_needed
from rastrainer.inference.signed_ranks import mean_ranks, signed_rank_test
from rastrainer.inference.student import (
    noncentral_cdf,
    noncentrality_interval,
    t_quantile,
    two_sided_p,
    upper_p,
)

rng = np.random.default_rng(3)
SAMPLES = [rng.normal(0.4, 1.0, n) for n in (3, 4, 5, 8, 12, 25, 60)]
DARWIN = np.array([49, -67, 8, 16, 6, 23, 28, 41, 14, 29, 56, 24, 75, 60, -48]) / 8
"""Darwin's fifteen pairs of maize, inches (Fisher 1935, The Design of Experiments, chapter 3)."""


@pytest.mark.parametrize("dof", [1, 2, 3, 7, 30, 200])
def test_students_distribution_agrees_with_scipy(dof):
    for t in (-6.0, -1.0, 0.0, 0.3, 2.5, 40.0):
        assert upper_p(t, dof) == pytest.approx(scipy.stats.t.sf(t, dof), rel=1e-8)
        assert two_sided_p(t, dof) == pytest.approx(2 * scipy.stats.t.sf(abs(t), dof), rel=1e-8)
    for probability in (0.001, 0.3, 0.975, 0.999):
        expected = scipy.stats.t.ppf(probability, dof)
        assert t_quantile(probability, dof) == pytest.approx(expected, rel=1e-7, abs=1e-9)


@pytest.mark.parametrize("dof", [1, 2, 3, 9, 40, 200])
def test_the_noncentral_distribution_agrees_with_scipy(dof):
    for t in (-2.0, 0.5, 2.0, 6.0):
        for shift in (-1.0, 0.0, 1.5, 4.0):
            expected = scipy.stats.nct.cdf(t, dof, shift) if shift else scipy.stats.t.cdf(t, dof)
            assert noncentral_cdf(t, dof, shift) == pytest.approx(expected, abs=1e-9)


def test_the_interval_of_the_noncentrality_puts_t_at_its_tails():
    low, high = noncentrality_interval(2.4, 7, 0.95)
    assert scipy.stats.nct.cdf(2.4, 7, low) == pytest.approx(0.975, abs=1e-6)
    assert scipy.stats.nct.cdf(2.4, 7, high) == pytest.approx(0.025, abs=1e-6)


def test_darwins_maize_gives_fishers_t():
    comparison = compare_paired(np.zeros(15), DARWIN)
    assert comparison.t == pytest.approx(2.148, abs=5e-4)
    assert comparison.mean_difference * 8 == pytest.approx(20.933, abs=5e-4)


@pytest.mark.parametrize("values", SAMPLES, ids=len)
def test_the_paired_t_test_agrees_with_scipy(values):
    first = rng.normal(10, 3, len(values))
    comparison = compare_paired(first, first + values)
    expected = scipy.stats.ttest_rel(first + values, first)
    assert comparison.t == pytest.approx(expected.statistic, rel=1e-9)
    assert comparison.p == pytest.approx(expected.pvalue, rel=1e-7)
    interval = expected.confidence_interval(0.95)
    np.testing.assert_allclose(comparison.interval, [interval.low, interval.high], rtol=1e-7)


@pytest.mark.parametrize("values", SAMPLES, ids=len)
def test_the_signed_rank_test_agrees_with_scipys_exact_one(values):
    result = signed_rank_test(values)
    expected = scipy.stats.wilcoxon(values, method="exact")
    assert result.p == pytest.approx(expected.pvalue, rel=1e-9)
    total = len(values) * (len(values) + 1) / 2
    assert min(result.positive_ranks, total - result.positive_ranks) == expected.statistic


def test_ties_and_zeros_keep_the_signed_rank_test_exact():
    values = np.array([0.0, 1.0, 1.0, -1.0, 2.0, 2.0, 3.0, -3.0, 4.0])
    signs = np.array(np.meshgrid(*[[-1, 1]] * 8)).reshape(8, -1)
    ranks = scipy.stats.rankdata(np.abs(values[1:]))
    np.testing.assert_array_equal(mean_ranks(np.abs(values[1:])), ranks)
    sums = (ranks[:, None] * (signs > 0)).sum(axis=0)
    observed = ranks[values[1:] > 0].sum()
    expected = 2 * min(np.mean(sums <= observed), np.mean(sums >= observed))
    result = signed_rank_test(values)
    assert (result.n, result.p) == (8, pytest.approx(min(1.0, expected)))


def test_the_interval_of_the_shift_covers_what_it_says():
    generator = np.random.default_rng(0)
    for n in (4, 6, 12):
        results = [signed_rank_test(generator.normal(0.5, 1, n)) for _ in range(400)]
        covered = np.mean([r.interval[0] <= 0.5 <= r.interval[1] for r in results])
        assert covered == pytest.approx(results[0].coverage, abs=0.035)
    assert signed_rank_test(SAMPLES[1]).coverage == pytest.approx(0.875)
    assert signed_rank_test(SAMPLES[4]).coverage >= 0.95


def test_hedges_factor_is_the_tabulated_one():
    """Hedges 1981, table 2: c(2) = .5642, c(3) = .7236, c(10) = .9228, c(50) = .9849."""
    for dof, expected in [(2, 0.5642), (3, 0.7236), (10, 0.9228), (50, 0.9849)]:
        assert small_sample_factor(dof) == pytest.approx(expected, abs=6e-5)


def test_the_interval_of_the_effect_size_covers_the_truth():
    generator = np.random.default_rng(1)
    hits = 0
    for _ in range(100):
        low, high = compare_paired(np.zeros(10), generator.normal(0.6, 1.0, 10)).gz_interval
        hits += low <= 0.6 * small_sample_factor(9) <= high
    assert hits / 100 == pytest.approx(0.95, abs=0.05)


def test_at_the_margin_of_equivalence_the_larger_of_two_one_sided_tests_has_5_percent():
    values = SAMPLES[5]
    margin = equivalence_margin(compare_paired(np.zeros(25), values))
    above = scipy.stats.ttest_1samp(values, -margin, alternative="greater").pvalue
    below = scipy.stats.ttest_1samp(values, margin, alternative="less").pvalue
    assert max(above, below) == pytest.approx(0.05, rel=1e-7)


def test_holms_correction_is_that_of_his_example_by_hand():
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == pytest.approx([1.0, 1.0])
    assert holm([]) == []


def test_power_is_that_of_the_tables():
    """Cohen 1988 / G*Power: d_z 0.5 needs 34 pairs, 0.2 needs 199, 0.8 needs 15 (power .80)."""
    assert [subjects_needed(size) for size in (0.2, 0.5, 0.8)] == [199, 34, 15]
    assert paired_power(0.5, 34) == pytest.approx(0.8078, abs=5e-4)
    assert paired_power(0.0, 12) == pytest.approx(0.05, abs=1e-8)
    assert paired_power(detectable_effect(4), 4) == pytest.approx(0.8, abs=1e-5)
    with pytest.raises(InputError, match="more than 10000 subjects"):
        subjects_needed(0.001)


def test_a_correlation_has_scipys_p_and_fishers_interval():
    x, y = rng.normal(size=(2, 12))
    ours, theirs = correlation(x, y + x), scipy.stats.pearsonr(x, y + x)
    assert (ours.r, ours.p) == (pytest.approx(theirs.statistic), pytest.approx(theirs.pvalue))
    interval = theirs.confidence_interval(0.95)
    np.testing.assert_allclose(ours.interval, [interval.low, interval.high], rtol=1e-9)
    assert correlation([1, 2, 3], [1, 2, 4]).interval is None


@pytest.mark.parametrize(
    ("first", "second", "words"),
    [([1.0], [2.0], "at least two subjects"), ([1.0, 2.0], [2.0, 3.0], "by the same amount")],
)
def test_what_cannot_be_compared_is_refused(first, second, words):
    with pytest.raises(InputError, match=words):
        compare_paired(np.array(first), np.array(second))


def test_differences_of_zero_alone_are_refused():
    with pytest.raises(InputError, match="differences that are not 0"):
        signed_rank_test(np.zeros(5))


def test_the_words_about_few_subjects_tell_the_limits():
    words = " ".join(what_cannot_be_concluded(4))
    assert "smallest possible p is 0.125" in words
    assert "199, 34 or 15 subjects" in words
    assert "1.9 times" in words or "2.0 times" in words or "2.1 times" in words
    assert "Wilcoxon" not in " ".join(what_cannot_be_concluded(30))
    assert "no comparison" in what_cannot_be_concluded(1)[0]


def test_a_difference_that_is_not_shown_is_not_called_absent():
    comparison = compare_paired(np.array([1.0, 2.0, 3.0]), np.array([1.2, 1.8, 3.4]))
    words = what_it_shows("Time", "s", "desktop", "hmd", comparison, 1.0)
    assert "not evidence that there is none" in words
    clear = compare_paired(np.zeros(9), np.linspace(1.0, 1.5, 9))
    assert "1.25 s higher with hmd" in what_it_shows("Time", "s", "desktop", "hmd", clear, 0.001)
    assert "does not hold" in what_it_shows("Time", "s", "desktop", "hmd", clear, 0.06)
    assert not math.isnan(clear.hedges_gz)
