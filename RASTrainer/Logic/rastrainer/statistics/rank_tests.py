"""Wilcoxon's signed-rank and rank-sum tests, exact for any number of ties."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.statistics.scipy_modules import scipy_module

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
