"""The standardized mean difference of paired conditions, and its interval."""

from __future__ import annotations

import math

from rastrainer.scipy_modules import scipy_module

CONFIDENCE = 0.95


def small_sample_factor(dof: float) -> float | None:
    """Return Hedges' J, by which a standardized difference of few subjects is too large.

    None for one degree of freedom: no estimate is unbiased there.
    """
    if dof <= 1:
        return None
    log = math.lgamma(dof / 2) - math.lgamma((dof - 1) / 2)
    return math.exp(log) / math.sqrt(dof / 2)


def noncentrality_interval(
    t: float, dof: float, confidence: float = CONFIDENCE
) -> tuple[float, float]:
    """Return the noncentralities between which an observed t is not surprising.

    (Steiger and Fouladi 1997: at each end, t is the quantile of its tail.) Divided by √n they are
    the limits of the population's effect size itself. They are not multiplied by Hedges' J, which
    corrects the estimate: with it they would cover too rarely.
    """
    tail = (1 - confidence) / 2
    return _noncentrality(t, dof, 1 - tail), _noncentrality(t, dof, tail)


def _noncentrality(t: float, dof: float, probability: float) -> float:
    """Return the noncentrality at which so much of the distribution lies below t."""
    below = scipy_module("stats").nct.cdf

    def excess(noncentrality: float) -> float:
        share = float(below(t, dof, noncentrality))
        # Far out in a tail, scipy gives no number.
        share = float(noncentrality < t) if math.isnan(share) else share
        return share - probability

    low, high, step = t - 1.0, t + 1.0, 2.0
    while excess(low) < 0:
        low, step = low - step, 2 * step
    while excess(high) > 0:
        high, step = high + step, 2 * step
    return float(scipy_module("optimize").brentq(excess, low, high, xtol=1e-12))
