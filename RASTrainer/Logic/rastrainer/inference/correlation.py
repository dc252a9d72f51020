"""Pearson's correlation with its interval and test."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from rastrainer.errors import InputError
from rastrainer.inference.student import two_sided_p


@dataclass(frozen=True)
class Correlation:
    """Pearson's r of n pairs, r², its two-sided p and its 95 % interval (Fisher's z)."""

    n: int
    r: float
    r_squared: float
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
    r = float(np.clip(np.corrcoef(x, y)[0, 1], -1.0, 1.0))
    n = len(x)
    t = math.inf if abs(r) == 1 else r * math.sqrt((n - 2) / (1 - r * r))
    interval = None
    if n > 3 and abs(r) < 1:
        reach = NormalDist().inv_cdf(0.975) / math.sqrt(n - 3)
        interval = (math.tanh(math.atanh(r) - reach), math.tanh(math.atanh(r) + reach))
    return Correlation(n, r, r * r, two_sided_p(t, n - 2), interval)
