"""When is a trainee competent? LC-CUSUM (Biau and Porcher 2010).

The usual CUSUM starts from a competent operator. LC-CUSUM starts from the hypothesis that the
trainee is not competent yet, and signals when the trials speak against that.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

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
    success, failure = log_likelihood_ratios(adequate, inadequate)
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
    success, _ = log_likelihood_ratios(adequate, inadequate)
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


@functools.lru_cache(maxsize=256)
def signal_probability(
    failure_rate: float, trials: int, adequate: float, inadequate: float, limit: float
) -> float:
    """Return the exact probability of a signal within `trials`, by following every score."""
    success, failure = log_likelihood_ratios(adequate, inadequate)
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


def log_likelihood_ratios(adequate: float, inadequate: float) -> tuple[float, float]:
    """Return what a success adds and a failure takes off."""
    if not 0 < adequate < inadequate < 1:
        raise InputError(
            "A CUSUM needs an acceptable failure rate above 0 and a larger, unacceptable one "
            "below 1."
        )
    return math.log((1 - adequate) / (1 - inadequate)), math.log(adequate / inadequate)
