"""Wilcoxon's signed-rank test, exact for any number of ties, and the shift that goes with it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.scipy_modules import scipy_module

MOST_EXACT = 400


@dataclass(frozen=True)
class SignedRankTest:
    """What the signs and ranks of the differences say.

    Attributes:
        n: Differences that are not 0.
        positive_ranks: Sum of the ranks of the differences above 0.
        p: Two-sided, exact.
        smallest_p: What the p of so few differences cannot fall below.
        shift: Hodges and Lehmann's estimate, the median of the Walsh averages.
        interval: Of the shift; its coverage is at least the one asked for, or as near as so few
            differences allow.
        coverage: What it really covers.
    """

    n: int
    positive_ranks: float
    p: float
    smallest_p: float
    shift: float
    interval: tuple[float, float]
    coverage: float


def signed_rank_test(differences: np.ndarray, confidence: float = 0.95) -> SignedRankTest:
    """Test whether (n,) float differences scatter about 0.

    Zeros are left out (Wilcoxon 1945); tied sizes share their mean rank. The distribution is that
    of all 2ⁿ signs of the ranks that were observed.

    Raises:
        InputError: no difference but zeros, or more than 400.
    """
    values = np.asarray(differences, dtype=float)
    values = values[values != 0]
    if not 0 < len(values) <= MOST_EXACT:
        raise InputError(
            f"The signed-rank test needs 1 to {MOST_EXACT} differences that are not 0."
        )
    # Twice the ranks, since tied ones are halves: whole numbers can be counted.
    doubled = np.rint(2 * scipy_module("stats").rankdata(np.abs(values))).astype(int)
    counts = _distribution(doubled)
    observed = int(doubled[values > 0].sum())
    lower, upper = counts[: observed + 1].sum(), counts[observed:].sum()
    walsh = _walsh_averages(values)
    interval, coverage = _interval(walsh, len(values), confidence)
    return SignedRankTest(
        n=len(values),
        positive_ranks=observed / 2,
        p=float(min(1.0, 2 * min(lower, upper))),
        smallest_p=float(min(1.0, 2 * counts[0])),
        shift=float(np.median(walsh)),
        interval=interval,
        coverage=coverage,
    )


def _distribution(doubled_ranks: np.ndarray) -> np.ndarray:
    """Return the probability of each sum of ranks with random signs, (sum + 1,) float."""
    counts = np.zeros(int(doubled_ranks.sum()) + 1)
    counts[0] = 1.0
    for rank in doubled_ranks:
        counts[rank:] += counts[: len(counts) - rank].copy()
        counts /= 2
    return counts


def _walsh_averages(values: np.ndarray) -> np.ndarray:
    rows, columns = np.triu_indices(len(values))
    return np.sort((values[rows] + values[columns]) / 2)


def _interval(walsh: np.ndarray, n: int, confidence: float) -> tuple[tuple[float, float], float]:
    """Return two Walsh averages and the coverage of what is between (Hollander and Wolfe 1999)."""
    below = np.cumsum(_distribution(2 * np.arange(1, n + 1))[::2])
    allowed = np.flatnonzero(below <= (1 - confidence) / 2)
    cut = int(allowed[-1]) if len(allowed) else 0
    return (float(walsh[cut]), float(walsh[-1 - cut])), float(1 - 2 * below[cut])
