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
    """A pass mark, and its errors if the scores of both groups are normal.

    Attributes:
        score: Those at or above it pass.
    """

    score: float
    passing_novices: float
    failing_experts: float
    observed_passing_novices: float
    observed_failing_experts: float


def pass_mark(novices: Sequence[float], experts: Sequence[float]) -> PassMark:
    """Return the score at which the normal curves of both groups cross between their means.

    Args:
        novices: One score a person, such as the mean of the last trials.
        experts: The same; higher is better.
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
    score = _crossing(below, above)
    return PassMark(
        score=score,
        passing_novices=1 - below.cdf(score),
        failing_experts=above.cdf(score),
        observed_passing_novices=float(np.mean(low >= score)),
        observed_failing_experts=float(np.mean(high < score)),
    )


def _crossing(below: NormalDist, above: NormalDist) -> float:
    """Return where the densities cross between the means, or the point of equal errors."""
    left, right = below.mean, above.mean
    if below.pdf(left) < above.pdf(left) or above.pdf(right) < below.pdf(right):
        # One curve covers the other's mean: they do not cross between the means.
        return (left * above.stdev + right * below.stdev) / (above.stdev + below.stdev)
    apart = scipy.optimize.brentq(lambda score: below.pdf(score) - above.pdf(score), left, right)
    return float(apart)
