"""Student's t distribution, central and noncentral, on numpy alone."""

from __future__ import annotations

import math

import numpy as np

from rastrainer.distributions import f_tail

POINTS = 401


def two_sided_p(t: float, dof: float) -> float:
    """Return the probability of a t at least as far from 0."""
    return f_tail(t * t, 1, dof)


def upper_p(t: float, dof: float) -> float:
    """Return the probability of a t above this one."""
    half = two_sided_p(t, dof) / 2
    return half if t >= 0 else 1 - half


def t_quantile(probability: float, dof: float) -> float:
    """Return the t that is not exceeded with this probability, between 0 and 1."""
    return _solve(lambda t: 1 - upper_p(t, dof), probability, -1.0, 1.0)


def noncentral_cdf(t: float, dof: float, noncentrality: float) -> float:
    """Return P(T ≤ t) for T = (Z + noncentrality)/√(χ²/dof).

    It is the mean of Φ(t·s − noncentrality) over s = √(χ²/dof), by the trapezoidal rule over
    u = ln s, which converges exponentially.
    """
    # Outside, the density of u is below exp(-40) of its peak.
    u, step = np.linspace(-40 / dof - 0.5, math.sqrt(40 / dof), POINTS, retstep=True)
    s = np.exp(u)
    log_constant = math.log(2) + dof / 2 * math.log(dof / 2) - math.lgamma(dof / 2)
    weights = np.exp(log_constant + dof * u - dof * s**2 / 2)
    below = [0.5 * math.erfc(value) for value in (noncentrality - t * s) / math.sqrt(2)]
    return float(weights @ below * step)


def noncentrality_interval(t: float, dof: float, confidence: float) -> tuple[float, float]:
    """Return the noncentralities between which an observed t is not surprising.

    (Steiger and Fouladi 1997: at each end, t is the quantile of its tail.)
    """
    tail = (1 - confidence) / 2
    low, high = (
        -_solve(lambda negative: noncentral_cdf(t, dof, -negative), p, -t - 1, -t + 1)
        for p in (1 - tail, tail)
    )
    return low, high


def _solve(rising, value: float, low: float, high: float) -> float:
    """Return where a rising function takes a value; the bracket is widened as needed."""
    width = high - low
    while rising(low) > value:
        width *= 2
        low -= width
    while rising(high) < value:
        width *= 2
        high += width
    while high - low > 1e-10 * max(1.0, abs(low), abs(high)):
        middle = (low + high) / 2
        if rising(middle) < value:
            low = middle
        else:
            high = middle
    return (low + high) / 2
