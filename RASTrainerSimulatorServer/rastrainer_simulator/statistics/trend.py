"""Do times or errors fall from trial to trial? A test that five trials are enough for.

A curve with a free rate and plateau has as many parameters as the published protocol has trials to
spare, and no criterion can prefer it. Two facts make a test out of five trials: practice does not
make slower or worse, so the test is one-sided; and it gains most at first, so the trials are set
against the logarithm of their number. The p-value is the share of all orders of the same values
that would fall as steeply. It is exact for independent values of any distribution, skewed or
heavy-tailed, too. Where they fall, a power law describes how.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
import scipy

from rastrainer.errors import InputError
from rastrainer_simulator.statistics.intervals import ALPHA, Estimate, mean
from rastrainer_simulator.statistics.paired import holm_by_name

MIN_TRIALS = 4
"""Three trials have six orders: their smallest p is 1/6."""
STEADY = 0.1
"""A fall by less than this share of the mean is called none; our own convention."""
MAX_ORDERS = 9999
"""All orders of up to seven trials are used, and this many random orders of more trials."""


class TrendVerdict(Enum):
    """The direction of a series of trials."""

    FALLS = "falls"
    STEADY = "steady"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class Trend:
    """How a trainee's values change.

    Attributes:
        change: From the first to the last trial on the fitted line over ln(trial), with its 90 %
            interval (Student's t): both ends are one-sided limits at 5 %.
        verdict: Falls where p is at most .05 (6 of the 120 orders of five trials); steady where
            not, and the interval holds neither a fall nor a rise by a tenth of the mean; undecided
            where it may be either.
    """

    change: Estimate
    p: float
    verdict: TrendVerdict


def falling_trend(values: Sequence[float] | np.ndarray) -> Trend:
    """Test whether (n,) times or errors of consecutive trials fall."""
    y = np.asarray(values, dtype=float)
    if len(y) < MIN_TRIALS or not np.isfinite(y).all():
        raise InputError(
            f"Whether trials improve can be tested from {MIN_TRIALS} finite values on."
        )
    x, weights = np.log(np.arange(1, len(y) + 1)), change_weights(len(y))
    change = float(weights @ y)
    residuals = y - y.mean() - change * (x - x.mean()) / x[-1]
    error = float(np.sqrt(residuals @ residuals / (len(y) - 2) * (weights @ weights)))
    reach = float(scipy.stats.t.ppf(1 - ALPHA, len(y) - 2)) * error
    # The share of the orders of y whose change is as far below 0.
    p = float(
        scipy.stats.permutation_test(
            (y,),
            lambda ordered, axis: (np.moveaxis(ordered, axis, -1) * weights).sum(axis=-1),
            permutation_type="pairings",
            alternative="less",
            vectorized=True,
            n_resamples=MAX_ORDERS,
            random_state=np.random.default_rng(0),
        ).pvalue
    )
    interval = (change - reach, change + reach)
    verdict = TrendVerdict.UNDECIDED
    if p <= ALPHA + 1e-12:
        verdict = TrendVerdict.FALLS
    elif max(-interval[0], interval[1]) < STEADY * float(np.abs(y).mean()):
        verdict = TrendVerdict.STEADY
    return Trend(Estimate(change, interval), p, verdict)


def change_weights(trials: int) -> np.ndarray:
    """Return the (n,) float weights that sum the values of n trials to their change.

    The change is from the first trial to the last on the least-squares line over ln(trial).
    """
    x = np.log(np.arange(1, trials + 1))
    offsets = x - x.mean()
    return offsets * (x[-1] - x[0]) / (offsets @ offsets)


def cohort_trend_p(rows: np.ndarray) -> float:
    """Test by Page (1963) whether (m, n) values of m trainees fall over their n trials.

    Only the ranks within trainees count, so that slow and quick trainees count alike. Returns p.
    """
    values = np.asarray(rows, dtype=float)
    if values.ndim != 2 or values.shape[0] < 2 or values.shape[1] < 3:
        raise InputError("Page's test needs at least two trainees with three trials each.")
    falling = np.arange(values.shape[1], 0, -1)
    return float(scipy.stats.page_trend_test(values, predicted_ranks=falling).pvalue)


@dataclass(frozen=True)
class CohortTrend:
    """How one outcome of several trainees, those with four trials or more, changes.

    The means are at each trial, as far as all have come, and `change` is the trainees' mean change
    from the first of these trials to the last; None of a single one.
    """

    trainees: int
    means: tuple[float, ...]
    change: Estimate | None
    p: float | None
    adjusted_p: float | None
    verdicts: Counter[TrendVerdict]

    @property
    def is_shown(self) -> bool:
        if self.adjusted_p is None:
            return self.verdicts[TrendVerdict.FALLS] > 0
        return self.adjusted_p < ALPHA


Series = Sequence[Sequence[float]]


def cohort_trends(tested: Sequence[tuple[Series, int]]) -> list[CohortTrend | None]:
    """Return the trend of several trainees in each of some outcomes, with p adjusted (Holm).

    `tested` has, for each outcome, the values of all trials of each trainee, in their order; and -1
    if less is better, 1 if more is. The trend is None if no trainee has four trials.
    """
    found = [_cohort_trend(*each) for each in tested]
    known = {at: each.p for at, each in enumerate(found) if each and each.p is not None}
    adjusted = holm_by_name(known)
    return [each and replace(each, adjusted_p=adjusted.get(at)) for at, each in enumerate(found)]


def _cohort_trend(series: Series, better: int) -> CohortTrend | None:
    long = [np.asarray(own, dtype=float) for own in series if len(own) >= MIN_TRIALS]
    if not long:
        return None
    common = min(map(len, long))
    rows = np.array([own[:common] for own in long])
    toward = -better
    verdicts = Counter(falling_trend(toward * own).verdict for own in long)
    change = p = None
    if len(rows) > 1:
        change = mean(rows @ change_weights(common))
        p = cohort_trend_p(toward * rows)
    means = tuple(rows.mean(axis=0).tolist())
    return CohortTrend(len(rows), means, change, p, p, verdicts)


MIN_FIT_TRIALS = 5
RATES = np.geomspace(0.02, 4.0, 200)


@dataclass(frozen=True)
class LearningCurve:
    """The power law of practice y = a·n^−b + c over the trials n = 1, 2, …, fitted.

    It describes (Newell and Rosenbloom 1981), in the unit of the values; the test says whether
    there is learning at all. The plateau of few trials is a guess: it lies beyond them.

    Its gain is a, its rate b and its plateau c; `r_squared` is the share of the variance that it
    explains.
    """

    gain: float
    rate: float
    plateau: float
    r_squared: float

    def at(self, trial: float) -> float:
        return self.gain * trial**-self.rate + self.plateau


def fit_learning_curve(values: Sequence[float]) -> LearningCurve:
    """Fit the power law to (n,) values of consecutive trials by least squares.

    Gain and plateau are not below 0: times and errors fall with practice and stay above 0.
    """
    y = np.asarray(values, dtype=float)
    if len(y) < MIN_FIT_TRIALS:
        raise InputError(f"A learning curve needs at least {MIN_FIT_TRIALS} trials.")
    if not np.all(np.isfinite(y) & (y >= 0)):
        raise InputError("A learning curve needs times or errors that are finite and not below 0.")
    trials = np.arange(1, len(y) + 1)
    fits = []
    for rate in RATES.tolist():
        columns = np.column_stack([trials**-rate, np.ones(len(y))])
        (gain, plateau), off = scipy.optimize.nnls(columns, y)
        fits.append((float(off), float(gain), rate, float(plateau)))
    off, gain, rate, plateau = min(fits, key=lambda fit: fit[0])
    total = float(((y - y.mean()) ** 2).sum())
    return LearningCurve(gain, rate, plateau, 1 - off**2 / total if total > 0 else 0.0)
