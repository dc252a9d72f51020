"""Two conditions on the same subjects: difference, interval, effect size and tests.

Wilcoxon's signed-rank and rank-sum tests are exact for any number of ties.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.statistics.crossover import (
    Sequences,
    compare_sequences,
    fit_differences,
    is_separable,
)
from rastrainer.statistics.intervals import (
    CONFIDENCE,
    coefficient,
    noncentrality_interval,
    scipy_module,
    small_sample_factor,
)


@dataclass(frozen=True)
class PairedComparison:
    """Two conditions, compared on the subjects who did both.

    Attributes:
        n: Subjects.
        mean_difference: Mean of second minus first; free of the effect of the period where
            `sequences` is not None.
        standard_error: Of it.
        dof: Degrees of freedom of it.
        interval: 95 % interval of the mean difference (Student's t).
        t: Of the t-test.
        p: Two-sided, of the t-test.
        hedges_gz: Mean difference over its standard deviation, corrected for few subjects; None
            with one degree of freedom.
        gz_interval: 95 % interval of the population's own (noncentral t); None likewise.
        ranks: Wilcoxon's signed ranks, or his rank sums where periods are separated; None where
            neither can be computed.
        sequences: What the order did; None where it is unknown, or the same for all.
    """

    n: int
    mean_difference: float
    standard_error: float
    dof: int
    interval: tuple[float, float]
    t: float
    p: float
    hedges_gz: float | None
    gz_interval: tuple[float, float] | None
    ranks: SignedRankTest | RankSumTest | None
    sequences: Sequences | None = None


def compare_paired(
    first: np.ndarray, second: np.ndarray, order: np.ndarray | None = None
) -> PairedComparison:
    """Compare two conditions, (n,) float each, of the same subjects in the same order.

    The t-test is Student's (1908), with the period as a covariate where the order allows it. The
    effect size is Cohen's d_z with Hedges' exact correction (1981).

    Args:
        first: One condition.
        second: The other one.
        order: (n,) float, by how many periods each subject did the second condition later than the
            first; None where that is unknown.

    Raises:
        InputError: fewer than two subjects, or all differences are equal.
    """
    first, second = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    differences, n = second - first, len(first)
    if n < 2:
        raise InputError("A paired comparison needs at least two subjects who did both.")
    order = np.asarray(order, dtype=float) if is_separable(order) else None
    fit = fit_differences(differences, order)
    mean, sd = float(fit.mean), float(fit.sd)
    if sd <= 1e-12 * max(1.0, float(np.abs(differences).max())):
        raise InputError("All subjects differ by the same amount: no test can be computed.")
    error = float(fit.standard_error)
    t, dof = mean / error, fit.dof
    gz, gz_interval = _effect_size(mean, sd, error, dof)
    return PairedComparison(
        n=n,
        mean_difference=mean,
        standard_error=error,
        dof=dof,
        interval=coefficient(mean, error, dof).interval,
        t=t,
        p=float(2 * scipy_module("stats").t.sf(abs(t), dof)),
        hedges_gz=gz,
        gz_interval=gz_interval,
        ranks=rank_test(differences, order),
        sequences=None if order is None else compare_sequences(first, second, order, fit),
    )


def equivalence_margin(comparison: PairedComparison) -> float:
    """Return the least margin within which the difference is shown to lie, in its unit.

    For every margin above it two one-sided tests at 5 % both reject (Schuirmann 1987). Whether so
    small a difference may be neglected must be decided before the study.
    """
    quantile = float(scipy_module("stats").t.ppf(CONFIDENCE, comparison.dof))
    return abs(comparison.mean_difference) + quantile * comparison.standard_error


def holm(p_values: np.ndarray) -> np.ndarray:
    """Return p-values adjusted for multiple testing (Holm 1979), in order along the last axis.

    Args:
        p_values: (…, k) float.
    """
    p_values = np.asarray(p_values, dtype=float)
    order = np.argsort(p_values, axis=-1)
    weights = np.arange(p_values.shape[-1], 0, -1)
    ranked = np.take_along_axis(p_values, order, axis=-1) * weights
    adjusted = np.empty(p_values.shape)
    ranked = np.minimum(np.maximum.accumulate(ranked, axis=-1), 1.0)
    np.put_along_axis(adjusted, order, ranked, axis=-1)
    return adjusted


def _effect_size(
    mean: float, sd: float, error: float, dof: int
) -> tuple[float | None, tuple[float, float] | None]:
    factor = small_sample_factor(dof)
    if factor is None:
        return None, None
    low, high = noncentrality_interval(mean / error, dof)
    return factor * mean / sd, (low * error / sd, high * error / sd)


def rank_test(
    differences: np.ndarray, order: np.ndarray | None
) -> SignedRankTest | RankSumTest | None:
    """Return the rank test that goes with (n,) differences: with the period, where it is separated.

    Args:
        differences: Second condition minus first.
        order: As for `compare_paired`, where it is separable; else None.
    """
    if order is None:
        return signed_rank_test(differences) if np.any(differences) else None
    size = np.abs(order).max()
    if not np.all(np.abs(order) == size):
        # Ranks know no regression: only two sequences that mirror each other can be compared.
        return None
    later_minus_earlier = differences * np.sign(order)
    return rank_sum_test(later_minus_earlier[order > 0], later_minus_earlier[order < 0])


MAX_SIGNED = 400


@dataclass(frozen=True)
class SignedRankTest:
    """The signed-rank test of differences.

    Attributes:
        n: Number of differences that are not 0.
        p: Two-sided, exact.
        smallest_p: Smallest possible p for these differences.
    """

    n: int
    p: float
    smallest_p: float


def signed_rank_test(differences: np.ndarray) -> SignedRankTest:
    """Test whether (n,) float differences scatter about 0.

    Zeros are left out (Wilcoxon 1945); tied sizes share their mean rank. The distribution is that
    of all 2ⁿ signs of the ranks that were observed.

    Raises:
        InputError: no difference but zeros, or more than 400.
    """
    values = np.asarray(differences, dtype=float)
    values = values[values != 0]
    if not 0 < len(values) <= MAX_SIGNED:
        raise InputError(
            f"The signed-rank test needs 1 to {MAX_SIGNED} differences that are not 0."
        )
    # Twice the ranks, since tied ones are halves: whole numbers can be counted.
    doubled = np.rint(2 * scipy_module("stats").rankdata(np.abs(values))).astype(int)
    counts = _distribution(doubled)
    observed = int(doubled[values > 0].sum())
    lower, upper = counts[: observed + 1].sum(), counts[observed:].sum()
    return SignedRankTest(
        n=len(values),
        p=float(min(1.0, 2 * min(lower, upper))),
        smallest_p=float(min(1.0, 2 * counts[0])),
    )


def _distribution(doubled_ranks: np.ndarray) -> np.ndarray:
    """Return the probability of each sum of ranks with random signs, (sum + 1,) float."""
    counts = np.zeros(int(doubled_ranks.sum()) + 1)
    counts[0] = 1.0
    for rank in doubled_ranks:
        counts[rank:] += counts[: len(counts) - rank].copy()
        counts /= 2
    return counts


MAX_EXACT_SUMS = 100


@dataclass(frozen=True)
class RankSumTest:
    """The rank-sum test of two groups.

    Attributes:
        p: Two-sided; exact, or by the normal approximation for more than 100 values.
        smallest_p: Smallest possible p; 0 for more than 100 values.
    """

    p: float
    smallest_p: float


def rank_sum_test(one: np.ndarray, other: np.ndarray) -> RankSumTest | None:
    """Test whether (n,) and (m,) float values have equal location; None if a group is empty.

    The distribution is that of all draws of n of the observed ranks; tied values share their mean
    rank, which scipy's exact test does not support.
    """
    if not len(one) or not len(other):
        return None
    stats = scipy_module("stats")
    ranks = stats.rankdata(np.concatenate([one, other]))
    if len(ranks) > MAX_EXACT_SUMS:
        p = float(stats.mannwhitneyu(one, other, method="asymptotic").pvalue)
        return RankSumTest(p, 0.0)
    # Twice the ranks, since tied ones are halves: whole numbers can be counted.
    doubled = np.rint(2 * ranks).astype(int)
    chances = _sum_probabilities(doubled, len(one))
    observed = int(doubled[: len(one)].sum())
    lower, upper = chances[: observed + 1].sum(), chances[observed:].sum()
    possible = np.flatnonzero(chances)
    smallest = min(chances[possible[0]], chances[possible[-1]])
    return RankSumTest(
        p=float(min(1.0, 2 * min(lower, upper))),
        smallest_p=float(min(1.0, 2 * smallest)),
    )


def _sum_probabilities(doubled_ranks: np.ndarray, drawn: int) -> np.ndarray:
    """Return the probability of each sum of `drawn` ranks, (sum + 1,) float."""
    counts = np.zeros((drawn + 1, int(doubled_ranks.sum()) + 1))
    counts[0, 0] = 1.0
    for rank in doubled_ranks:
        counts[1:, rank:] += counts[:-1, : counts.shape[1] - rank].copy()
    return counts[drawn] / math.comb(len(doubled_ranks), drawn)
