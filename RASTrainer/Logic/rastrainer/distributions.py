"""Tails of the F distribution, for tests and intervals without scipy."""

from __future__ import annotations

import math


def f_tail(value: float, numerator: float, denominator: float) -> float:
    """Return the probability that an F variable exceeds `value`.

    Args:
        value: Not below 0; may be infinite.
        numerator: Degrees of freedom of the numerator.
        denominator: Degrees of freedom of the denominator.
    """
    if math.isinf(value):
        return 0.0
    x = denominator / (denominator + numerator * value)
    return incomplete_beta(denominator / 2, numerator / 2, x)


def incomplete_beta(a: float, b: float, x: float) -> float:
    """Return the regularized incomplete beta function I_x(a, b), a and b > 0, x from 0 to 1."""
    if x <= 0.0:
        return 0.0
    if x >= 1.0:
        return 1.0
    # The continued fraction converges fast only below the mean; beyond it, use the symmetry.
    if x > (a + 1.0) / (a + b + 2.0):
        return 1.0 - incomplete_beta(b, a, 1.0 - x)
    log_front = (
        math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)
    )
    return math.exp(log_front) / (a * _continued_fraction(a, b, x))


def _continued_fraction(a: float, b: float, x: float, terms: int = 200) -> float:
    """Return 1 + d₁/(1 + d₂/(1 + …)) of DLMF 8.17.22, evaluated from its last term backwards."""
    value = 1.0
    for n in range(terms, 0, -1):
        m = n // 2
        if n % 2:
            d = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        else:
            d = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        value = 1.0 + d / value
    return value
