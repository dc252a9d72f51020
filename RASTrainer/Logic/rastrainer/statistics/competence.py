"""When is a trainee competent? LC-CUSUM (Biau and Porcher 2010) and a pass mark from two groups.

The usual CUSUM starts from a competent operator. LC-CUSUM starts from the hypothesis that the
trainee is not competent yet, and signals when the trials speak against that. The pass mark is where
the scores of novices and experts separate (contrasting groups; Livingston and Zieky 1982).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from rastrainer.errors import InputError
from rastrainer.number_text import percent

FALSE_DISCOVERY = 0.05
"""Largest share of inadequate trainees who are called competent within the training."""


@dataclass(frozen=True)
class LcCusum:
    """The chart of a trainee.

    Attributes:
        scores: After each trial; a success adds, a failure subtracts, never below 0.
        limit: A score at or above it shows competence.
        competent_at: Number of the trial (from 1) that showed it, or None.
        false_discovery: Probability of this signal within as many trials at the inadequate failure
            rate.
    """

    scores: tuple[float, ...]
    limit: float
    competent_at: int | None
    false_discovery: float


def lc_cusum(failures: Sequence[bool], adequate: float, inadequate: float, limit: float) -> LcCusum:
    """Return the chart of a trainee's failures."""
    success, failure = _steps(adequate, inadequate)
    if not limit > 0:
        raise InputError("The limit of an LC-CUSUM must be above 0.")
    scores, score, competent_at = [], 0.0, None
    for number, failed in enumerate(failures, start=1):
        score = max(0.0, score + (failure if failed else success))
        scores.append(score)
        if competent_at is None and score >= limit:
            competent_at = number
    risk = signal_probability(inadequate, len(scores), adequate, inadequate, limit)
    return LcCusum(tuple(scores), limit, competent_at, risk)


@functools.lru_cache(maxsize=32)
def lc_cusum_limit(adequate: float, inadequate: float, trials: int) -> float:
    """Return the least limit that an incompetent trainee reaches too rarely."""
    success, _ = _steps(adequate, inadequate)
    least = signal_probability(inadequate, trials, adequate, inadequate, trials * success)
    if least > FALSE_DISCOVERY:
        raise InputError(
            f"{trials} trials cannot show competence at a risk of {percent(FALSE_DISCOVERY)}: even "
            "successes alone are too likely by chance."
        )
    low, high = 0.0, trials * success
    while high - low > 1e-6:
        middle = (low + high) / 2
        risk = signal_probability(inadequate, trials, adequate, inadequate, middle)
        low, high = (low, middle) if risk <= FALSE_DISCOVERY else (middle, high)
    return high


def fewest_trials(adequate: float, inadequate: float, limit: float) -> int:
    """Return the least number of trials that can show competence: successes only."""
    success, _ = _steps(adequate, inadequate)
    return math.ceil(limit / success - 1e-12)


def chance_of_successes(count: int, trials: int, adequate: float, inadequate: float) -> float:
    """Return the probability that an inadequate trainee reaches the score of `count` successes."""
    success, _ = _steps(adequate, inadequate)
    return signal_probability(inadequate, trials, adequate, inadequate, count * success)


@functools.lru_cache(maxsize=256)
def signal_probability(
    failure_rate: float, trials: int, adequate: float, inadequate: float, limit: float
) -> float:
    """Return the exact probability of a signal within `trials`, by following every score."""
    success, failure = _steps(adequate, inadequate)
    # A score is a number of successes and of failures since it was last 0.
    open_scores, signaled = {(0, 0): 1.0}, 0.0
    for _ in range(trials):
        following: dict[tuple[int, int], float] = {}
        for (good, bad), probability in open_scores.items():
            for is_failure, share in ((False, 1 - failure_rate), (True, failure_rate)):
                state = (good, bad + 1) if is_failure else (good + 1, bad)
                score = state[0] * success + state[1] * failure
                if score >= limit - 1e-12:
                    signaled += probability * share
                else:
                    state = state if score > 0 else (0, 0)
                    following[state] = following.get(state, 0.0) + probability * share
        open_scores = following
    return min(1.0, signaled)


def _steps(adequate: float, inadequate: float) -> tuple[float, float]:
    """Return what a success adds and a failure takes off: log likelihood ratios."""
    if not 0 < adequate < inadequate < 1:
        raise InputError(
            "A CUSUM needs an acceptable failure rate above 0 and a larger, unacceptable one "
            "below 1."
        )
    return math.log((1 - adequate) / (1 - inadequate)), math.log(adequate / inadequate)


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
    while right - left > 1e-9 * (1 + abs(left)):
        middle = (left + right) / 2
        if below.pdf(middle) > above.pdf(middle):
            left = middle
        else:
            right = middle
    return (left + right) / 2
