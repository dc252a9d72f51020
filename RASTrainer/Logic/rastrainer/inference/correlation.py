"""Pearson's correlation with its interval and test."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.scipy_modules import scipy_module


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
