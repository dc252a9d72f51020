"""Estimates with 95 % intervals: coefficients, means, variances and differences of mean squares."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from rastrainer.statistics.intervals import CONFIDENCE
from rastrainer.statistics.scipy_modules import scipy_module

TAIL = (1 - CONFIDENCE) / 2


@dataclass(frozen=True)
class Estimate:
    """A value and its 95 % interval."""

    value: float
    interval: tuple[float, float]

    def __neg__(self) -> Estimate:
        low, high = self.interval
        return Estimate(-self.value, (-high, -low))

    def holds(self, truth: float) -> bool:
        """Return whether the interval contains a true value."""
        return self.interval[0] <= truth <= self.interval[1]


@dataclass(frozen=True)
class MeanSquare:
    """A mean square σ²·χ²/dof and its degrees of freedom."""

    value: float
    dof: float


def coefficient(value: float, error: float, dof: float) -> Estimate:
    """Return a normal estimate whose standard error has so many degrees of freedom."""
    reach = t_quantile(dof) * error
    return Estimate(value, (value - reach, value + reach))


def mean(values: np.ndarray) -> Estimate:
    """Return the mean of (n,) float independent values, n ≥ 2."""
    error = float(values.std(ddof=1)) / math.sqrt(len(values))
    return coefficient(float(values.mean()), error, len(values) - 1)


def variance(square: MeanSquare) -> Estimate:
    """Return the variance that a mean square estimates."""
    low, high = (chi2_ratio(tail, square.dof) for tail in (TAIL, 1 - TAIL))
    return Estimate(square.value, (square.value / high, square.value / low))


def difference(first: MeanSquare, second: MeanSquare) -> Estimate:
    """Return the difference of the variances that two independent mean squares estimate.

    The limits are those of Ting et al. (1990), the modified large-sample interval of Burdick and
    Graybill (1992). They may be below 0.
    """
    one, other = first.value, second.value
    difference_ = one - other
    products = np.array([one**2, other**2, one * other])
    low, high = (
        products @ factors
        for factors in (
            _factors(TAIL, first.dof, second.dof),
            _factors(1 - TAIL, first.dof, second.dof),
        )
    )
    return Estimate(
        difference_,
        (difference_ - math.sqrt(max(low, 0.0)), difference_ + math.sqrt(max(high, 0.0))),
    )


@functools.lru_cache(maxsize=256)
def _factors(tail: float, dof: float, other_dof: float) -> np.ndarray:
    """Return the factors of both squares and of their product in the square of one reach.

    Args:
        tail: Probability above the quantile of the first mean square: small for the lower limit.
        dof: Of the first mean square.
        other_dof: Of the second.
    """
    own = 1 - 1 / chi2_ratio(1 - tail, dof)
    others = 1 - 1 / chi2_ratio(tail, other_dof)
    ratio = float(scipy_module("stats").f.isf(tail, dof, other_dof))
    product = ((ratio - 1) ** 2 - (own * ratio) ** 2 - others**2) / ratio
    return np.array([own**2, others**2, product])


@functools.lru_cache(maxsize=256)
def t_quantile(dof: float) -> float:
    """Return by how many standard errors a 95 % interval reaches to either side."""
    return float(scipy_module("stats").t.isf(TAIL, dof))


@functools.lru_cache(maxsize=256)
def chi2_ratio(probability: float, dof: float) -> float:
    """Return the quantile of χ²/dof."""
    return float(scipy_module("stats").chi2.ppf(probability, dof)) / dof
