"""Whether the trainees of a mode get better from trial to trial, together and each alone."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.inference.effect_size import CONFIDENCE
from rastrainer.learning.trend import (
    ALPHA,
    FEWEST_TRIALS,
    Verdict,
    change_weights,
    cohort_trend_p,
    falling_trend,
)
from rastrainer.scipy_modules import scipy_module


@dataclass(frozen=True)
class CohortTrend:
    """How one outcome of several trainees goes on.

    Attributes:
        trainees: Those with four trials or more.
        means: Of them at each trial, as far as all have come.
        change: Mean over the trainees of the change from the first of these trials to the last;
            None of a single one.
        interval: 95 % interval of it; None of a single one.
        p: One-sided, of all getting better (Page's test); None of a single one.
        verdicts: How many trainees alone show what.
    """

    trainees: int
    means: tuple[float, ...]
    change: float | None
    interval: tuple[float, float] | None
    p: float | None
    verdicts: Counter[Verdict]

    @property
    def is_shown(self) -> bool:
        """Whether getting better is more than chance."""
        if self.p is None:
            return self.verdicts[Verdict.FALLS] > 0
        return self.p < ALPHA


def cohort_trend(series: Sequence[Sequence[float]], better: int) -> CohortTrend | None:
    """Return the trend of several trainees; None where nobody has four trials.

    Args:
        series: Of each trainee the values of all trials, in their order.
        better: -1 where less is better, 1 where more is.
    """
    long = [np.asarray(own, dtype=float) for own in series if len(own) >= FEWEST_TRIALS]
    if not long:
        return None
    common = min(map(len, long))
    rows = np.array([own[:common] for own in long])
    toward = -better
    verdicts = Counter(falling_trend(toward * own).verdict for own in long)
    change = interval = p = None
    if len(rows) > 1:
        changes = rows @ change_weights(common)
        change = float(changes.mean())
        error = float(changes.std(ddof=1)) / np.sqrt(len(rows))
        reach = float(scipy_module("stats").t.ppf((1 + CONFIDENCE) / 2, len(rows) - 1)) * error
        interval = (change - reach, change + reach)
        p = cohort_trend_p(toward * rows)
    return CohortTrend(len(rows), tuple(rows.mean(axis=0).tolist()), change, interval, p, verdicts)
