"""Wilcoxon's rank-sum test (Mann and Whitney's U), exact for any number of ties."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rastrainer.scipy_modules import scipy_module

MOST_EXACT = 100


@dataclass(frozen=True)
class RankSumTest:
    """What the ranks of two groups say.

    Attributes:
        rank_sum: Of the first group, among all.
        p: Two-sided; exact, or by the normal approximation for more than 100 values.
        smallest_p: What the p of so few values cannot fall below; 0 for more than 100.
    """

    rank_sum: float
    p: float
    smallest_p: float


def rank_sum_test(one: np.ndarray, other: np.ndarray) -> RankSumTest | None:
    """Test whether (n,) and (m,) float values lie alike; None where one group is empty.

    The distribution is that of all ways to draw n of the observed ranks; tied values share their
    mean rank, which scipy's exact test does not know.
    """
    if not len(one) or not len(other):
        return None
    stats = scipy_module("stats")
    ranks = stats.rankdata(np.concatenate([one, other]))
    if len(ranks) > MOST_EXACT:
        p = float(stats.mannwhitneyu(one, other, method="asymptotic").pvalue)
        return RankSumTest(float(ranks[: len(one)].sum()), p, 0.0)
    # Twice the ranks, since tied ones are halves: whole numbers can be counted.
    doubled = np.rint(2 * ranks).astype(int)
    ways = _ways(doubled, len(one))
    observed = int(doubled[: len(one)].sum())
    lower, upper = ways[: observed + 1].sum(), ways[observed:].sum()
    possible = np.flatnonzero(ways)
    smallest = min(ways[possible[0]], ways[possible[-1]])
    return RankSumTest(
        rank_sum=observed / 2,
        p=float(min(1.0, 2 * min(lower, upper))),
        smallest_p=float(min(1.0, 2 * smallest)),
    )


def _ways(doubled_ranks: np.ndarray, drawn: int) -> np.ndarray:
    """Return the probability of each sum of so many ranks, (sum + 1,) float."""
    counts = np.zeros((drawn + 1, int(doubled_ranks.sum()) + 1))
    counts[0, 0] = 1.0
    for rank in doubled_ranks:
        counts[1:, rank:] += counts[:-1, : counts.shape[1] - rank].copy()
    return counts[drawn] / math.comb(len(doubled_ranks), drawn)
