"""One figure of a simulation and its limit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from rastrainer.number_text import fixed


@dataclass(frozen=True)
class Measured:
    """How often something happened in simulated data sets.

    Attributes:
        case: What was simulated, in words.
        share: From 0 to 1.
        sets: Of how many data sets.
        at_most: Upper limit of the share; None if it is only reported.
        at_least: Lower limit of the share; None if it is only reported.
        further: Further figures of the same data sets, as text.
    """

    case: str
    share: float
    sets: int
    at_most: float | None = None
    at_least: float | None = None
    further: tuple[str, ...] = ()

    def holds(self, standard_errors: float = 0.0) -> bool:
        """Return whether the share is within the limit, with a tolerance in standard errors."""

        def slack(limit: float) -> float:
            return standard_errors * float(np.sqrt(limit * (1 - limit) / self.sets))

        over = self.at_most is None or self.share <= self.at_most + slack(self.at_most)
        if self.at_least is None:
            return over
        return over and self.share >= self.at_least - slack(self.at_least)

    def cells(self) -> list[str]:
        """Return the row of a table."""
        asked = "–"
        if self.at_most is not None and self.at_least is not None:
            asked = f"{share_text(self.at_least, 0)} to {share_text(self.at_most, 0)}"
        elif self.at_most is not None:
            asked = f"≤ {share_text(self.at_most, 0)}"
        elif self.at_least is not None:
            asked = f"≥ {share_text(self.at_least, 0)}"
        return [self.case, share_text(self.share), asked, *self.further]


def holds(interval: tuple[float, float] | None, truth: float) -> bool:
    return interval is not None and interval[0] <= truth <= interval[1]


def share_of(happened: Sequence[bool] | np.ndarray) -> float:
    """Return the share of true values."""
    return float(np.mean(happened))


def share_text(share: float, digits: int = 1) -> str:
    """Return a share in percent."""
    return f"{fixed(100 * share, digits)} %"


class Row(Protocol):
    """A row of a table."""

    at_most: float | None
    at_least: float | None

    def holds(self, standard_errors: float = 0.0) -> bool:
        """Return whether the figure is within the limit, with a tolerance in standard errors."""

    def cells(self) -> list[str]:
        """Return case, figure, limit, and further figures."""


def markdown(header: Sequence[str], found: Sequence[Row]) -> str:
    """Return a table; `header` names the case, the figure and the further figures."""
    lines = [[header[0], header[1], "required", *header[2:]], ["---"] * (len(header) + 1)]
    lines += [one.cells() for one in found]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
