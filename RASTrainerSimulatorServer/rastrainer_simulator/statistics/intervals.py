"""Estimates with their intervals, and the power of paired tests."""

from __future__ import annotations

import bisect
import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from rastrainer.errors import InputError

CONFIDENCE = 0.95
TAIL = (1 - CONFIDENCE) / 2


def small_sample_factor(dof: float) -> float | None:
    """Return Hedges' J, by which a standardized difference of few subjects is too large.

    None for one degree of freedom: no estimate is unbiased there.
    """
    if dof <= 1:
        return None
    log = math.lgamma(dof / 2) - math.lgamma((dof - 1) / 2)
    return math.exp(log) / math.sqrt(dof / 2)


def noncentrality_interval(t: float, dof: float) -> tuple[float, float]:
    """Return the noncentralities between which an observed t is not surprising.

    (Steiger and Fouladi 1997: at each end, t is the quantile of its tail.) Divided by √n they are
    the limits of the population's effect size itself. They are not multiplied by Hedges' J, which
    corrects the estimate: with it they would cover too rarely.
    """

    def excess(noncentrality: float, probability: float) -> float:
        share = float(scipy.stats.nct.cdf(t, dof, noncentrality))
        # Far out in a tail, scipy gives no number.
        share = float(noncentrality < t) if math.isnan(share) else share
        return share - probability

    limits = []
    for tail in (1 - TAIL, TAIL):
        low, high, step = t - 1.0, t + 1.0, 2.0
        while excess(low, tail) < 0:
            low, step = low - step, 2 * step
        while excess(high, tail) > 0:
            high, step = high + step, 2 * step
        # `scipy.special.nctdtrinc` is accurate to 10⁻⁶ only.
        limits.append(float(scipy.optimize.brentq(excess, low, high, args=(tail,), xtol=1e-12)))
    return limits[0], limits[1]


ALPHA = 0.05
TARGET_POWER = 0.8
MAX_SUBJECTS = 10_000


def paired_power(effect_dz: float, n: int, with_period: bool = False) -> float:
    """Return the probability that n subjects show an effect (two-sided paired t-test, 5 %).

    The effect is the true mean difference over the true standard deviation of the differences. The
    effect of the period, if separated (`with_period`), takes a degree of freedom; the orders are
    taken as balanced.
    """
    dof = n - 1 - with_period
    critical, shift = scipy.stats.t.ppf(1 - ALPHA / 2, dof), effect_dz * math.sqrt(n)
    if shift == 0:
        return ALPHA
    noncentral = scipy.stats.nct(dof, abs(shift))
    above, below = noncentral.sf(critical), noncentral.cdf(-critical)
    # Far out in a tail, scipy gives no number: there, all or nothing lies beyond.
    return float(np.nan_to_num(above, nan=1.0) + np.nan_to_num(below, nan=0.0))


def subjects_needed(effect_dz: float, with_period: bool = False) -> int:
    sizes = range(2 + with_period, MAX_SUBJECTS + 1)
    place = bisect.bisect_left(
        sizes, TARGET_POWER, key=lambda n: paired_power(effect_dz, n, with_period)
    )
    if place == len(sizes):
        raise InputError(
            f"An effect of {effect_dz:g} standard deviations would need more than "
            f"{MAX_SUBJECTS} subjects."
        )
    return sizes[place]


def detectable_effect(n: int, with_period: bool = False) -> float:
    """Return the effect d_z that n subjects show with `TARGET_POWER`; as of `paired_power`."""
    high = 1.0
    while paired_power(high, n, with_period) < TARGET_POWER:
        high *= 2
    return float(
        scipy.optimize.brentq(
            lambda effect: paired_power(effect, n, with_period) - TARGET_POWER, 0.0, high
        )
    )


@dataclass(frozen=True)
class Correlation:
    """Pearson's r of n pairs, its two-sided p and its 95 % interval (Fisher's z)."""

    n: int
    r: float
    p: float
    interval: tuple[float, float] | None


def correlation(x: np.ndarray, y: np.ndarray) -> Correlation:
    """Return the correlation of (n,) float pairs; of three pairs the interval is None."""
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if len(x) < 3 or np.ptp(x) == 0 or np.ptp(y) == 0:
        raise InputError("A correlation needs three pairs of values that vary.")
    found = scipy.stats.pearsonr(x, y)
    interval = None
    if len(x) > 3 and abs(found.statistic) < 1:
        limits = found.confidence_interval(0.95)
        interval = (float(limits.low), float(limits.high))
    return Correlation(len(x), float(found.statistic), float(found.pvalue), interval)


@dataclass(frozen=True)
class Estimate:
    """A value and its 95 % interval."""

    value: float
    interval: tuple[float, float]

    def mapped(self, function: Callable[[float], float]) -> Estimate:
        """Return the estimate on another scale, by a function that rises."""
        low, high = map(function, self.interval)
        return Estimate(function(self.value), (low, high))


@dataclass(frozen=True)
class MeanSquare:
    """A mean square σ²·χ²/dof and its degrees of freedom."""

    value: float
    dof: float


def coefficient(value: float, error: float, dof: float) -> Estimate:
    """Return a normal estimate whose standard error has so many degrees of freedom."""
    reach = float(scipy.stats.t.isf(TAIL, dof)) * error
    return Estimate(value, (value - reach, value + reach))


def mean(values: np.ndarray) -> Estimate:
    """Return the mean of (n,) float independent values, n ≥ 2."""
    error = float(values.std(ddof=1)) / math.sqrt(len(values))
    return coefficient(float(values.mean()), error, len(values) - 1)


def rms(values: Sequence[float] | np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def variance(square: MeanSquare) -> Estimate:
    high, low = scipy.stats.chi2.ppf((TAIL, 1 - TAIL), square.dof) / square.dof
    return Estimate(square.value, (square.value / float(low), square.value / float(high)))


def difference(first: MeanSquare, second: MeanSquare) -> Estimate:
    """Return the difference of the variances that two independent mean squares estimate.

    Ting et al. (1990) give the limits, the modified large-sample interval of Burdick and Graybill
    (1992). They may be below 0.
    """
    one, other = first.value, second.value
    products = np.array([one**2, other**2, one * other])
    below, above = (
        math.sqrt(max(float(products @ _factors(tail, first.dof, second.dof)), 0.0))
        for tail in (TAIL, 1 - TAIL)
    )
    return Estimate(one - other, (one - other - below, one - other + above))


@functools.lru_cache(maxsize=256)
def _factors(tail: float, dof: float, other_dof: float) -> np.ndarray:
    """Return the factors of both squares and of their product in the square of one reach.

    `tail`, the probability above the first mean square's quantile, is small for the lower limit.
    """
    own = 1 - dof / scipy.stats.chi2.ppf(1 - tail, dof)
    others = 1 - other_dof / scipy.stats.chi2.ppf(tail, other_dof)
    ratio = scipy.stats.f.isf(tail, dof, other_dof)
    product = ((ratio - 1) ** 2 - (own * ratio) ** 2 - others**2) / ratio
    return np.array([own**2, others**2, product])
