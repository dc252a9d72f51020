"""Control charts that add up: has a trainee's performance drifted from its target?"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError


@dataclass(frozen=True)
class TabularCusum:
    """A two-sided CUSUM of measurements (Page 1954, in Montgomery's tabular form).

    Attributes:
        above: Sum of what exceeded the target by more than the allowance, after each value.
        below: The same downwards.
        signals: Numbers of the values (the first is 1) at which a sum exceeded the limit.
    """

    above: tuple[float, ...]
    below: tuple[float, ...]
    signals: tuple[int, ...]


def tabular_cusum(
    values: Sequence[float], target: float, allowance: float, limit: float
) -> TabularCusum:
    """Return the chart of measurements; all arguments have their unit.

    Args:
        values: In their order.
        target: What is aimed at.
        allowance: k, half the shift that shall be found, usually half a standard deviation.
        limit: h, usually five standard deviations.
    """
    above, below, signals = [], [], []
    high = low = 0.0
    for number, value in enumerate(values, start=1):
        high = max(0.0, high + value - target - allowance)
        low = max(0.0, low + target - allowance - value)
        above.append(high)
        below.append(low)
        if max(high, low) > limit:
            signals.append(number)
    return TabularCusum(tuple(above), tuple(below), tuple(signals))


@dataclass(frozen=True)
class FailureCusum:
    """A CUSUM of successes and failures with Wald's boundaries (Kestin 1995).

    Attributes:
        success_step: s, what a success takes off; a failure adds 1 − s.
        lower: Going below it shows the acceptable failure rate.
        upper: Going above it shows the unacceptable one.
        sums: After each trial.
        acceptable_at: Number of the trial (the first is 1) at which the lower boundary was first
            crossed; None where it never was.
        unacceptable_at: The same for the upper one.
    """

    success_step: float
    lower: float
    upper: float
    sums: tuple[float, ...]
    acceptable_at: int | None
    unacceptable_at: int | None


def failure_cusum(
    failures: Sequence[bool],
    acceptable: float,
    unacceptable: float,
    alpha: float = 0.1,
    beta: float = 0.1,
) -> FailureCusum:
    """Return the chart of a trainee's failures.

    Args:
        failures: Whether each trial failed, in their order.
        acceptable: p₀, a failure rate that is acceptable.
        unacceptable: p₁, one that is not.
        alpha: Risk to call an acceptable trainee unacceptable.
        beta: Risk of the opposite.

    Raises:
        InputError: the rates are not 0 < acceptable < unacceptable < 1, or the risks not between
            0 and ½.
    """
    check_rates(acceptable, unacceptable)
    if not (0 < alpha < 0.5 and 0 < beta < 0.5):
        raise InputError("The risks of a CUSUM must be between 0 and 0.5.")
    p = math.log(unacceptable / acceptable)
    q = math.log((1 - acceptable) / (1 - unacceptable))
    step = q / (p + q)
    upper = math.log((1 - beta) / alpha) / (p + q)
    lower = -math.log((1 - alpha) / beta) / (p + q)
    sums = np.cumsum([1 - step if failed else -step for failed in failures])
    return FailureCusum(
        success_step=step,
        lower=lower,
        upper=upper,
        sums=tuple(map(float, sums)),
        acceptable_at=_first(sums <= lower),
        unacceptable_at=_first(sums >= upper),
    )


def check_rates(acceptable: float, unacceptable: float) -> None:
    """Raise `InputError` unless 0 < acceptable < unacceptable < 1."""
    if not 0 < acceptable < unacceptable < 1:
        raise InputError(
            "A CUSUM needs an acceptable failure rate above 0 and a larger, unacceptable one "
            "below 1."
        )


def _first(crossed: np.ndarray) -> int | None:
    found = np.flatnonzero(crossed)
    return int(found[0]) + 1 if len(found) else None
