"""Two conditions on the same subjects: difference, interval, effect size and tests.

A subject has more practice, or is more tired, in the later condition. If orders are balanced, half
of the subjects gain by this in one condition and half in the other: the mean difference is right,
but the differences scatter by twice the effect of the period, so a paired test finds little. The
regression here removes it (for two sequences AB and BA it is the usual analysis of a crossover:
Hills and Armitage 1979; Senn 2002, chapter 3).

Wilcoxon's signed-rank and rank-sum tests are exact for any number of ties.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import scipy

from rastrainer.errors import InputError
from rastrainer_simulator.statistics import intervals

Name = TypeVar("Name")
MIN_SUBJECTS = 4
"""Difference and period take two; one degree of freedom for the variance is not enough."""


@dataclass(frozen=True)
class DifferenceFit:
    """The mean of differences without the order's effect, and the period's if separated.

    Arrays have the shape of the data without its last axis.
    """

    mean: np.ndarray
    standard_error: np.ndarray
    sd: np.ndarray
    dof: int
    later: np.ndarray | None = None
    later_error: np.ndarray | None = None


def is_separable(order: np.ndarray | None) -> bool:
    """Return whether the effects of the period and of the conditions can be separated.

    `order`, (n,) float, is by how many periods each subject did the second condition later than the
    first: 1 for AB, -1 for BA; None if that is unknown.
    """
    if order is None or len(order) < MIN_SUBJECTS:
        return False
    return bool(np.ptp(order) > 0 and np.min(order) <= 0 <= np.max(order))


def fit_differences(differences: np.ndarray, order: np.ndarray | None = None) -> DifferenceFit:
    """Return the mean of (…, n) float differences, second condition minus first.

    `order` is as in `is_separable`; if the period cannot be separated, the plain mean is returned.
    """
    design = np.ones((differences.shape[-1], 1))
    if order is not None and is_separable(order):
        design = np.column_stack([design, order])
    inverse, dof = np.linalg.inv(design.T @ design), len(design) - design.shape[1]
    fitted = differences @ design @ inverse
    sd = np.sqrt(((differences - fitted @ design.T) ** 2).sum(axis=-1) / dof)
    errors = sd[..., None] * np.sqrt(np.diag(inverse))
    later = [found[..., 1] for found in (fitted, errors) if design.shape[1] > 1]
    return DifferenceFit(fitted[..., 0], errors[..., 0], sd, dof, *later)


@dataclass(frozen=True)
class Sequences:
    """Subjects by the condition that they did first.

    Attributes:
        later: What one period later adds.
        between: Mean over both conditions of the subjects who did the second condition first, minus
            the mean of the others; None with fewer than two subjects in a sequence. It differs from
            0 by chance or carry-over.
    """

    first_first: int
    second_first: int
    later: intervals.Estimate
    between: intervals.Estimate | None


def compare_sequences(
    first: np.ndarray, second: np.ndarray, order: np.ndarray, fit: DifferenceFit
) -> Sequences:
    """Return the effects of the order on (n,) float values of both conditions.

    `order` is as in `is_separable`; `fit` is the fit of the differences, with the period.
    """
    if fit.later is None or fit.later_error is None:
        raise ValueError("The effect of the period is not separated.")
    means, between = (first + second) / 2, None
    one, other = means[order > 0], means[order < 0]
    # One subject does not say how much they scatter.
    if min(len(one), len(other)) > 1 and np.ptp(means) > 0:
        low, high = scipy.stats.ttest_ind(other, one).confidence_interval(intervals.CONFIDENCE)
        between = intervals.Estimate(float(other.mean() - one.mean()), (float(low), float(high)))
    later = intervals.coefficient(float(fit.later), float(fit.later_error), fit.dof)
    return Sequences(len(one), len(other), later, between)


@dataclass(frozen=True)
class PairedComparison:
    """Two conditions, compared on the subjects who did both.

    Attributes:
        difference: Mean of second minus first; free of the effect of the period where
            `sequences` is not None.
        effect: Hedges' g_z, the mean difference over its standard deviation, corrected for few
            subjects, with the interval of the population's own (noncentral t); None with one
            degree of freedom.
        ranks: Wilcoxon's signed ranks, or his rank sums where periods are separated; None if
            neither can be computed.
        sequences: What the order did; None if it is unknown, or the same for all.
    """

    n: int
    difference: intervals.Estimate
    standard_error: float
    dof: int
    t: float
    p: float
    effect: intervals.Estimate | None
    ranks: RankTest | None
    sequences: Sequences | None = None


def compare_paired(
    first: np.ndarray, second: np.ndarray, order: np.ndarray | None = None
) -> PairedComparison:
    """Compare two conditions, (n,) float each, of the same subjects in the same order.

    The t-test is Student's (1908), with the period as a covariate where the order allows it. The
    effect size is Cohen's d_z with Hedges' exact correction (1981).

    `order` is as in `is_separable`.
    """
    first, second = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    differences, n = second - first, len(first)
    if n < 2:
        raise InputError("A paired comparison needs at least two subjects who did both.")
    order = np.asarray(order, dtype=float) if is_separable(order) else None
    fit = fit_differences(differences, order)
    mean, sd, error, dof = float(fit.mean), float(fit.sd), float(fit.standard_error), fit.dof
    if sd <= 1e-12 * max(1.0, float(np.abs(differences).max())):
        raise InputError("All subjects differ by the same amount: no test can be computed.")
    t = mean / error
    effect, factor = None, intervals.small_sample_factor(dof)
    if factor is not None:
        low, high = intervals.noncentrality_interval(t, dof)
        effect = intervals.Estimate(factor * mean / sd, (low * error / sd, high * error / sd))
    return PairedComparison(
        n=n,
        difference=intervals.coefficient(mean, error, dof),
        standard_error=error,
        dof=dof,
        t=t,
        p=float(2 * scipy.stats.t.sf(abs(t), dof)),
        effect=effect,
        ranks=rank_test(differences, order),
        sequences=None if order is None else compare_sequences(first, second, order, fit),
    )


def equivalence_margin(comparison: PairedComparison) -> float:
    """Return the least margin within which the difference is shown to lie, in its unit.

    For every margin above it two one-sided tests at 5 % both reject (Schuirmann 1987). Whether so
    small a difference may be neglected must be decided before the study.
    """
    quantile = float(scipy.stats.t.ppf(intervals.CONFIDENCE, comparison.dof))
    return abs(comparison.difference.value) + quantile * comparison.standard_error


def holm(p_values: np.ndarray) -> np.ndarray:
    """Return p-values adjusted for multiple testing (Holm 1979), in order along the last axis."""
    p_values = np.asarray(p_values, dtype=float)
    order = np.argsort(p_values, axis=-1)
    ranked = np.take_along_axis(p_values, order, axis=-1) * np.arange(p_values.shape[-1], 0, -1)
    ranked = np.minimum(np.maximum.accumulate(ranked, axis=-1), 1.0)
    return np.take_along_axis(ranked, np.argsort(order, axis=-1), axis=-1)


def holm_by_name(p_values: Mapping[Name, float]) -> dict[Name, float]:
    return dict(zip(p_values, holm(np.array([*p_values.values()])).tolist(), strict=True))


def rank_test(differences: np.ndarray, order: np.ndarray | None) -> RankTest | None:
    """Return the rank test of (n,) differences: with the period, where it is separated."""
    if order is None:
        return signed_rank_test(differences) if np.any(differences) else None
    size = np.abs(order).max()
    if not np.all(np.abs(order) == size):
        # Ranks know no regression: only two sequences that mirror each other can be compared.
        return None
    later_minus_earlier = differences * np.sign(order)
    return rank_sum_test(later_minus_earlier[order > 0], later_minus_earlier[order < 0])


@dataclass(frozen=True)
class RankTest:
    """A two-sided test on ranks, and the smallest p that they allow; 0 if p is approximate.

    p is exact, but for more than 100 values of two groups by the normal approximation.
    """

    p: float
    smallest_p: float


MAX_SIGNED = 400


def signed_rank_test(differences: np.ndarray) -> RankTest:
    """Test whether (n,) float differences scatter about 0.

    Zeros are left out (Wilcoxon 1945); tied sizes share their mean rank. All 2ⁿ signs of the
    observed ranks make the distribution.
    """
    values = np.asarray(differences, dtype=float)
    values = values[values != 0]
    if not 0 < len(values) <= MAX_SIGNED:
        raise InputError(
            f"The signed-rank test needs 1 to {MAX_SIGNED} differences that are not 0."
        )
    # Tied ranks are halves: whole numbers can be counted.
    doubled = np.rint(2 * scipy.stats.rankdata(np.abs(values))).astype(int)
    chances = np.zeros(int(doubled.sum()) + 1)
    chances[0] = 1.0
    for rank in doubled:
        chances[rank:] += chances[: len(chances) - rank].copy()
        chances /= 2
    return _exact_test(chances, int(doubled[values > 0].sum()))


MAX_EXACT_SUMS = 100


def rank_sum_test(one: np.ndarray, other: np.ndarray) -> RankTest | None:
    """Test whether (n,) and (m,) float values have equal location; None if a group is empty.

    All draws of n of the observed ranks make the distribution; tied values share their mean
    rank, which scipy's exact test does not support.
    """
    drawn = len(one)
    if not drawn or not len(other):
        return None
    ranks = scipy.stats.rankdata(np.concatenate([one, other]))
    if len(ranks) > MAX_EXACT_SUMS:
        return RankTest(
            float(scipy.stats.mannwhitneyu(one, other, method="asymptotic").pvalue), 0.0
        )
    doubled = np.rint(2 * ranks).astype(int)
    counts = np.zeros((drawn + 1, int(doubled.sum()) + 1))
    counts[0, 0] = 1.0
    for rank in doubled:
        counts[1:, rank:] += counts[:-1, : counts.shape[1] - rank].copy()
    chances = counts[drawn] / math.comb(len(doubled), drawn)
    return _exact_test(chances, int(doubled[:drawn].sum()))


def _exact_test(chances: np.ndarray, observed: int) -> RankTest:
    lower, upper = chances[: observed + 1].sum(), chances[observed:].sum()
    possible = np.flatnonzero(chances)
    smallest = min(chances[possible[0]], chances[possible[-1]])
    return RankTest(float(min(1.0, 2 * min(lower, upper))), float(min(1.0, 2 * smallest)))
