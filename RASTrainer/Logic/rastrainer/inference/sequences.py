"""What the order of two conditions did: the effect of the period, and what may be carried over."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.inference.effect_size import CONFIDENCE
from rastrainer.inference.period_effect import DifferenceFit
from rastrainer.scipy_modules import scipy_module

FEWEST = 2
"""Subjects of a sequence, to tell how much they scatter."""


@dataclass(frozen=True)
class Sequences:
    """Subjects by the condition that they did first.

    Attributes:
        first_first: How many did the first condition first.
        second_first: How many did the second one first.
        later: What one period later adds.
        later_interval: 95 % interval of it.
        between: Mean over both conditions of those who did the second one first, minus that of
            those who did the first one first; None with fewer than two subjects in one of both.
            Without carry-over it is 0 but for chance.
        between_interval: 95 % interval of it.
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
    """Return what the order did, of (n,) float values of both conditions.

    Args:
        first: One condition.
        second: The other one.
        order: By how many periods each subject did the second condition later than the first.
        fit: Of the differences, with the period.
    """
    stats = scipy_module("stats")
    reach = float(stats.t.ppf((1 + CONFIDENCE) / 2, fit.dof) * fit.later_error)
    later = float(fit.later)
    means = (first + second) / 2
    groups = means[order < 0], means[order > 0]
    between, between_interval = None, None
    if min(map(len, groups)) >= FEWEST and np.ptp(means) > 0:
        between = float(groups[0].mean() - groups[1].mean())
        limits = stats.ttest_ind(*groups).confidence_interval(CONFIDENCE)
        between_interval = (float(limits.low), float(limits.high))
    return Sequences(
        first_first=len(groups[1]),
        second_first=len(groups[0]),
        later=later,
        later_interval=(later - reach, later + reach),
        between=between,
        between_interval=between_interval,
    )
