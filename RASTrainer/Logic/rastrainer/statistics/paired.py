"""Two conditions on the same subjects: difference, interval, effect size and tests."""

from __future__ import annotations

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
    noncentrality_interval,
    small_sample_factor,
)
from rastrainer.statistics.rank_tests import (
    RankSumTest,
    SignedRankTest,
    rank_sum_test,
    signed_rank_test,
)
from rastrainer.statistics.scipy_modules import scipy_module


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
    students = scipy_module("stats").t
    reach = float(students.ppf((1 + CONFIDENCE) / 2, dof)) * error
    gz, gz_interval = _effect_size(mean, sd, error, dof)
    return PairedComparison(
        n=n,
        mean_difference=mean,
        standard_error=error,
        dof=dof,
        interval=(mean - reach, mean + reach),
        t=t,
        p=float(2 * students.sf(abs(t), dof)),
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
    """Return p-values adjusted for being several (Holm 1979), in their order along the last axis.

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
