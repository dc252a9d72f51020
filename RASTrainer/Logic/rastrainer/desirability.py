"""Desirabilities (Harrington 1965, Derringer and Suich 1980): 1 at best, falling toward 0."""

from __future__ import annotations

TIME_FLOOR = 0.04
"""Desirability of an infinite time: being slow never costs as much as being wrong."""


def falling(value: float, half: float, power: int = 2) -> float:
    """Return 1/(1 + (value/half)^power): 1 at 0, ½ at `half`; strictly falling, never 0."""
    return 1 / (1 + (value / half) ** power)


def of_time(time_s: float, reference_s: float) -> float:
    """Return the desirability of a time: half of its range at the reference."""
    return TIME_FLOOR + (1 - TIME_FLOOR) * falling(time_s, reference_s)
