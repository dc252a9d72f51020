"""Two conditions on the same subjects: difference, interval, effect size and tests."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.inference.signed_ranks import SignedRankTest, signed_rank_test
from rastrainer.inference.student import noncentrality_interval, t_quantile, two_sided_p

CONFIDENCE = 0.95


@dataclass(frozen=True)
class PairedComparison:
    """Two conditions, compared on the subjects who did both.

    Attributes:
        n: Subjects.
        mean_difference: Mean of second minus first.
        sd_difference: Standard deviation of the differences, divided by n − 1.
        interval: 95 % interval of the mean difference (Student's t).
        t: Of the paired t-test.
        p: Two-sided, of the paired t-test.
        hedges_gz: Mean difference over its standard deviation, corrected for few subjects.
        gz_interval: 95 % interval of it (noncentral t).
        signed_ranks: Wilcoxon's test, exact; None where all differences are 0.
    """

    n: int
    mean_difference: float
    sd_difference: float
    interval: tuple[float, float]
    t: float
    p: float
    hedges_gz: float
    gz_interval: tuple[float, float]
    signed_ranks: SignedRankTest | None


def compare_paired(first: np.ndarray, second: np.ndarray) -> PairedComparison:
    """Compare two conditions, (n,) float each, of the same subjects in the same order.

    The t-test is Student's (1908). The effect size is Cohen's d_z with Hedges' exact correction
    (1981); its interval follows from the noncentral t distribution (Steiger and Fouladi 1997).

    Raises:
        InputError: fewer than two subjects, or all differences are equal.
    """
    differences = np.asarray(second, dtype=float) - np.asarray(first, dtype=float)
    n = len(differences)
    if n < 2:
        raise InputError("A paired comparison needs at least two subjects who did both.")
    mean, sd = float(differences.mean()), float(differences.std(ddof=1))
    if sd <= 1e-12 * max(1.0, abs(mean)):
        raise InputError("All subjects differ by the same amount: no test can be computed.")
    dof, standard_error = n - 1, sd / math.sqrt(n)
    t = mean / standard_error
    reach = t_quantile((1 + CONFIDENCE) / 2, dof) * standard_error
    factor = small_sample_factor(dof)
    low, high = noncentrality_interval(t, dof, CONFIDENCE)
    return PairedComparison(
        n=n,
        mean_difference=mean,
        sd_difference=sd,
        interval=(mean - reach, mean + reach),
        t=t,
        p=two_sided_p(t, dof),
        hedges_gz=factor * mean / sd,
        gz_interval=(factor * low / math.sqrt(n), factor * high / math.sqrt(n)),
        signed_ranks=signed_rank_test(differences) if np.any(differences) else None,
    )


def small_sample_factor(dof: float) -> float:
    """Return Hedges' J, by which a standardized difference of few subjects is too large."""
    if dof <= 1:
        # Γ(0) has no value: one degree of freedom gives no unbiased estimate.
        return 0.0
    log = math.lgamma(dof / 2) - math.lgamma((dof - 1) / 2)
    return math.exp(log) / math.sqrt(dof / 2)


def equivalence_margin(comparison: PairedComparison) -> float:
    """Return the least margin within which the difference is shown to lie, in its unit.

    For every margin above it two one-sided tests at 5 % both reject (Schuirmann 1987). Whether so
    small a difference may be neglected must be decided before the study.
    """
    standard_error = comparison.sd_difference / math.sqrt(comparison.n)
    reach = t_quantile(CONFIDENCE, comparison.n - 1) * standard_error
    return abs(comparison.mean_difference) + reach


def holm(p_values: list[float]) -> list[float]:
    """Return the p-values adjusted for being several (Holm 1979), in their order."""
    order = np.argsort(p_values)
    adjusted = np.empty(len(p_values))
    largest = 0.0
    for rank, index in enumerate(order):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[index]))
        adjusted[index] = largest
    return adjusted.tolist()
