"""One figure of a simulation and its limits, as a row of a table."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.number_text import fixed


@dataclass(frozen=True)
class Measured:
    """A figure of simulated data sets.

    Attributes:
        figure: a share from 0 to 1, or a number if `is_share` is false.
        sets: how many data sets the share is of.
        further: other figures of the same data sets.
        slack: a number's tolerance, by the tolerance in standard errors; not for shares.
        also: a further condition with such a tolerance.
        digits: decimals of a number that is not a share.
    """

    case: str
    figure: float
    sets: int = 1
    at_most: float | None = None
    at_least: float | None = None
    further: tuple[str, ...] = ()
    is_share: bool = True
    slack: Callable[[float], float] = lambda _standard_errors: 0.0
    also: Callable[[float], bool] = lambda _standard_errors: True
    digits: int = 1

    def holds(self, standard_errors: float = 0.0) -> bool:
        """Return whether all is within its limits, with a tolerance in standard errors."""

        def slack(limit: float) -> float:
            if not self.is_share:
                return self.slack(standard_errors)
            return standard_errors * float(np.sqrt(limit * (1 - limit) / self.sets))

        least, most = self.at_least, self.at_most
        is_enough = least is None or self.figure >= least - slack(least)
        return (
            is_enough
            and (most is None or self.figure <= most + slack(most))
            and self.also(standard_errors)
        )

    def cells(self) -> list[str]:
        least, most = (
            limit is not None and (share_text(limit, 0) if self.is_share else f"{limit:g}")
            for limit in (self.at_least, self.at_most)
        )
        asked = f"{least} to {most}" if least and most else f"≥ {least}" if least else f"≤ {most}"
        figure = share_text(self.figure) if self.is_share else fixed(self.figure, self.digits)
        return [self.case, figure, asked if least or most else "–", *self.further]


def deviation(
    case: str, truth: float, value: float, standard_error: float, further: tuple[str, ...]
) -> Measured:
    """Return how far an estimate is off, in standard errors, of which two are allowed."""
    off = abs(value - truth) / standard_error
    return Measured(
        *(case, off),
        at_most=2.0,
        further=further,
        is_share=False,
        slack=lambda standard_errors: max(standard_errors - 2.0, 0.0),
    )


def holds(interval: tuple[float, float] | None, truth: float) -> bool:
    return interval is not None and interval[0] <= truth <= interval[1]


def share_of(happened: Sequence[bool] | np.ndarray) -> float:
    return float(np.mean(happened))


def share_text(share: float, digits: int = 1) -> str:
    return f"{fixed(100 * share, digits)} %"


def markdown(header: Sequence[str], found: Sequence[Measured]) -> str:
    """Return a table; `header` names the case, the figure and the further figures."""
    lines = [[header[0], header[1], "required", *header[2:]], ["---"] * (len(header) + 1)]
    lines += [one.cells() for one in found]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
