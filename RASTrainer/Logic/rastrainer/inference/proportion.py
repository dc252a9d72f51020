"""A share of trials with its interval."""

from __future__ import annotations

from dataclasses import dataclass

from rastrainer.scipy_modules import scipy_module


@dataclass(frozen=True)
class Proportion:
    """How many of how many.

    Attributes:
        count: For which it is so.
        total: Of how many, at least 1.
        interval: The 95 % interval of the share, from 0 to 1.
    """

    count: int
    total: int
    interval: tuple[float, float]

    @property
    def share(self) -> float:
        """From 0 to 1."""
        return self.count / self.total


def proportion(count: int, total: int) -> Proportion:
    """Return a share with the interval by Wilson (1927).

    It stays within 0 and 1 and keeps its 95 % for shares near them, as `count ± 2 SE` does not. It
    takes the trials as independent.

    Raises:
        InputError: scipy is missing.
    """
    interval = scipy_module("stats").binomtest(count, total).proportion_ci(0.95, "wilson")
    return Proportion(count, total, (float(interval.low), float(interval.high)))
