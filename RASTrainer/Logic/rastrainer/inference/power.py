"""How many subjects a paired t-test needs, and what few can show."""

from __future__ import annotations

import math

from rastrainer.errors import InputError
from rastrainer.inference.student import noncentral_cdf, t_quantile

ALPHA = 0.05
TARGET_POWER = 0.8
MOST_SUBJECTS = 10_000


def paired_power(effect_dz: float, n: int, alpha: float = ALPHA) -> float:
    """Return the probability that n subjects show an effect (two-sided paired t-test).

    Args:
        effect_dz: True mean difference over the true standard deviation of the differences.
        n: Subjects, at least 2.
        alpha: Level of the test.
    """
    critical = t_quantile(1 - alpha / 2, n - 1)
    shift = effect_dz * math.sqrt(n)
    return 1 - noncentral_cdf(critical, n - 1, shift) + noncentral_cdf(-critical, n - 1, shift)


def subjects_needed(effect_dz: float, power: float = TARGET_POWER, alpha: float = ALPHA) -> int:
    """Return the least number of subjects with this power.

    Raises:
        InputError: the effect is so small that more than 10 000 were needed.
    """
    low, high = 1, 2
    while paired_power(effect_dz, high, alpha) < power:
        low, high = high, 2 * high
        if high > MOST_SUBJECTS:
            raise InputError(
                f"An effect of {effect_dz:g} standard deviations would need more than "
                f"{MOST_SUBJECTS} subjects."
            )
    while high - low > 1:
        middle = (low + high) // 2
        if paired_power(effect_dz, middle, alpha) < power:
            low = middle
        else:
            high = middle
    return high


def detectable_effect(n: int, power: float = TARGET_POWER, alpha: float = ALPHA) -> float:
    """Return the effect d_z that n subjects show with this power."""
    low, high = 0.0, 1.0
    while paired_power(high, n, alpha) < power:
        low, high = high, 2 * high
    while high - low > 1e-6 * high:
        middle = (low + high) / 2
        if paired_power(middle, n, alpha) < power:
            low = middle
        else:
            high = middle
    return (low + high) / 2
