"""Pearson's correlation and a share of trials, each with its 95 % interval."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.statistics.scipy_modules import scipy_module


@dataclass(frozen=True)
class Correlation:
    """Pearson's r of n pairs, its two-sided p and its 95 % interval (Fisher's z)."""

    n: int
    r: float
    p: float
    interval: tuple[float, float] | None


def correlation(x: np.ndarray, y: np.ndarray) -> Correlation:
    """Return the correlation of (n,) float pairs; of three pairs the interval is None.

    Raises:
        InputError: fewer than three pairs, or one of both does not vary.
    """
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if len(x) < 3 or np.ptp(x) == 0 or np.ptp(y) == 0:
        raise InputError("A correlation needs three pairs of values that vary.")
    found = scipy_module("stats").pearsonr(x, y)
    interval = None
    if len(x) > 3 and abs(found.statistic) < 1:
        limits = found.confidence_interval(0.95)
        interval = (float(limits.low), float(limits.high))
    return Correlation(len(x), float(found.statistic), float(found.pvalue), interval)


@dataclass(frozen=True)
class Proportion:
    """How many of how many.

    Attributes:
        count: For which it is so.
        total: Of how many, at least 1.
        interval: The 95 % interval of the share, from 0 to 1.
    """

    count: int
    total: int
    interval: tuple[float, float]

    @property
    def share(self) -> float:
        """From 0 to 1."""
        return self.count / self.total


def proportion(count: int, total: int) -> Proportion:
    """Return a share with the interval by Wilson (1927).

    It stays within 0 and 1 and keeps its 95 % for shares near them, as `count ± 2 SE` does not. It
    takes the trials as independent.

    Raises:
        InputError: scipy is missing.
    """
    interval = scipy_module("stats").binomtest(count, total).proportion_ci(0.95, "wilson")
    return Proportion(count, total, (float(interval.low), float(interval.high)))
