"""Two conditions in sequence: their difference, separated from the effect of the order.

A subject has more practice, or is more tired, in the later condition. With balanced orders half of
the subjects gain by this in one condition and half in the other: the mean difference is right, but
the differences scatter by twice the effect of the period, so a paired test finds little. The
regression here removes it (for two sequences AB and BA it is the usual analysis of a crossover:
Hills and Armitage 1979; Senn 2002, chapter 3).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.statistics.intervals import CONFIDENCE, coefficient, scipy_module

MIN_SUBJECTS = 4
"""Difference and period take two; one degree of freedom for the variance is not enough."""


@dataclass(frozen=True)
class DifferenceFit:
    """The mean of differences, and the effect of the period if separated.

    Arrays have the shape of the data without its last axis.

    Attributes:
        mean: Difference for subjects unaffected by the order.
        standard_error: Of the mean.
        sd: Standard deviation of the differences about the fit.
        dof: Degrees of freedom.
        later: Effect of doing a condition one period later, or None.
        later_error: Its standard error, or None.
    """

    mean: np.ndarray
    standard_error: np.ndarray
    sd: np.ndarray
    dof: int
    later: np.ndarray | None = None
    later_error: np.ndarray | None = None


def is_separable(order: np.ndarray | None) -> bool:
    """Return whether the effect of the period can be separated from that of the conditions.

    Args:
        order: (n,) float, by how many periods each subject did the second condition later than the
            first: 1 for AB, -1 for BA; None where that is unknown.
    """
    if order is None or len(order) < MIN_SUBJECTS:
        return False
    return bool(np.ptp(order) > 0 and np.min(order) <= 0 <= np.max(order))


def fit_differences(differences: np.ndarray, order: np.ndarray | None = None) -> DifferenceFit:
    """Return the mean of (…, n) float differences, second condition minus first.

    Args:
        differences: A study in the last axis.
        order: As for `is_separable`; where it is not separable, the plain mean is returned.
    """
    n = differences.shape[-1]
    means = differences.mean(axis=-1)
    centered = differences - means[..., None]
    if order is None or not is_separable(order):
        sd = np.sqrt((centered**2).sum(axis=-1) / (n - 1))
        return DifferenceFit(means, sd / np.sqrt(n), sd, n - 1)
    offsets = order - order.mean()
    squares = float(offsets @ offsets)
    later = centered @ offsets / squares
    residuals = centered - later[..., None] * offsets
    sd = np.sqrt((residuals**2).sum(axis=-1) / (n - 2))
    return DifferenceFit(
        mean=means - later * order.mean(),
        standard_error=sd * np.sqrt(1 / n + order.mean() ** 2 / squares),
        sd=sd,
        dof=n - 2,
        later=later,
        later_error=sd / np.sqrt(squares),
    )


MIN_SEQUENCE_SIZE = 2
"""Subjects of a sequence, to estimate how much they scatter."""


@dataclass(frozen=True)
class Sequences:
    """Subjects by the condition that they did first.

    Attributes:
        first_first: Number who did the first condition first.
        second_first: Number who did the second one first.
        later: Effect of one period later.
        later_interval: Its 95 % interval.
        between: Mean over both conditions of those who did the second one first, minus that of the
            others; None with fewer than two subjects in a sequence. Without carry-over it is 0 but
            for chance.
        between_interval: Its 95 % interval.
    """

    first_first: int
    second_first: int
    later: float
    later_interval: tuple[float, float]
    between: float | None
    between_interval: tuple[float, float] | None


def compare_sequences(
    first: np.ndarray, second: np.ndarray, order: np.ndarray, fit: DifferenceFit
) -> Sequences:
    """Return the effects of the order on (n,) float values of both conditions.

    Args:
        first: First condition.
        second: Second condition.
        order: By how many periods each subject did the second condition later than the first.
        fit: Of the differences, with the period.

    Raises:
        ValueError: the fit does not separate the period.
    """
    if fit.later is None or fit.later_error is None:
        raise ValueError("The effect of the period is not separated.")
    later = coefficient(float(fit.later), float(fit.later_error), fit.dof)
    means = (first + second) / 2
    groups = means[order < 0], means[order > 0]
    between, between_interval = None, None
    if min(map(len, groups)) >= MIN_SEQUENCE_SIZE and np.ptp(means) > 0:
        between = float(groups[0].mean() - groups[1].mean())
        limits = scipy_module("stats").ttest_ind(*groups).confidence_interval(CONFIDENCE)
        between_interval = (float(limits.low), float(limits.high))
    return Sequences(
        first_first=len(groups[1]),
        second_first=len(groups[0]),
        later=later.value,
        later_interval=later.interval,
        between=between,
        between_interval=between_interval,
    )
