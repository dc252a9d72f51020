"""A pass mark where the scores of novices and experts separate.

(Contrasting groups; Livingston and Zieky 1982.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
import scipy

from rastrainer.errors import InputError

MIN_GROUP_SIZE = 5


@dataclass(frozen=True)
class PassMark:
    """A score at or above which people pass, and its errors if both groups are normal."""

    score: float
    passing_novices: float
    failing_experts: float
    observed_passing_novices: float
    observed_failing_experts: float


def pass_mark(novices: Sequence[float], experts: Sequence[float]) -> PassMark:
    """Return the score at which the normal curves of both groups cross between their means.

    Each person has one score, such as the mean of the last trials; higher is better.
    """
    low, high = np.asarray(novices, dtype=float), np.asarray(experts, dtype=float)
    if min(len(low), len(high)) < MIN_GROUP_SIZE:
        raise InputError(
            f"A pass mark by contrasting groups needs at least {MIN_GROUP_SIZE} novices and as "
            f"many experts; there are {len(low)} and {len(high)}."
        )
    if low.std() == 0 or high.std() == 0:
        raise InputError("A pass mark needs scores that differ within each group.")
    below = NormalDist(float(low.mean()), float(low.std(ddof=1)))
    above = NormalDist(float(high.mean()), float(high.std(ddof=1)))
    if not above.mean > below.mean:
        raise InputError("A pass mark needs experts who score higher than the novices.")
    left, right = below.mean, above.mean
    if below.pdf(left) < above.pdf(left) or above.pdf(right) < below.pdf(right):
        # One curve covers the other's mean, so that they do not cross between the means: the
        # point of equal errors.
        score = (left * above.stdev + right * below.stdev) / (above.stdev + below.stdev)
    else:
        score = float(scipy.optimize.brentq(lambda x: below.pdf(x) - above.pdf(x), left, right))
    return PassMark(
        score=score,
        passing_novices=1 - below.cdf(score),
        failing_experts=above.cdf(score),
        observed_passing_novices=float(np.mean(low >= score)),
        observed_failing_experts=float(np.mean(high < score)),
    )
