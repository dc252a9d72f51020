"""The power law of practice: y = a·n^−b + c over the trials n = 1, 2, …

The curve describes; whether there is learning at all is tested in `rastrainer.statistics.trend`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError

MIN_TRIALS = 5
RATES = np.geomspace(0.02, 4.0, 200)


@dataclass(frozen=True)
class LearningCurve:
    """A fitted power law (Newell and Rosenbloom 1981), in the unit of what was measured.

    Of few trials the plateau is a guess: it lies beyond them.

    Attributes:
        gain: a, how much the first trial is above the plateau.
        rate: b, how fast it falls.
        plateau: c, where it leads.
        r_squared: Share of the variance that the curve explains.
    """

    gain: float
    rate: float
    plateau: float
    r_squared: float

    def at(self, trial: float) -> float:
        """Return the value of the curve at a trial, the first is 1."""
        return self.gain * trial**-self.rate + self.plateau


def fit_learning_curve(values: Sequence[float]) -> LearningCurve:
    """Fit the power law to (n,) values of consecutive trials by least squares.

    Gain and plateau are not below 0: what is measured falls with practice and stays above 0, as
    times and errors do.

    Raises:
        InputError: fewer than five trials, or they hold no finite numbers of at least 0.
    """
    y = np.asarray(values, dtype=float)
    if len(y) < MIN_TRIALS:
        raise InputError(f"A learning curve needs at least {MIN_TRIALS} trials.")
    if not np.all(np.isfinite(y) & (y >= 0)):
        raise InputError("A learning curve needs times or errors that are finite and not below 0.")
    trials = np.arange(1, len(y) + 1)
    gains, plateaus, all_squares = _linear_fits(trials ** -RATES[:, None], y)
    best = int(np.argmin(all_squares))
    rate, gain = float(RATES[best]), float(gains[best])
    plateau, squares = float(plateaus[best]), float(all_squares[best])
    total = float(((y - y.mean()) ** 2).sum())
    return LearningCurve(
        gain=gain,
        rate=rate,
        plateau=plateau,
        r_squared=1 - squares / total if total > 0 else 0.0,
    )


def _linear_fits(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return gain, plateau, both at least 0, and sum of squares of y = gain·x + plateau.

    `x` is (k, n), a row a fit; the results are (k,).
    """
    centered = x - x.mean(axis=1, keepdims=True)
    gain = centered @ (y - y.mean()) / (centered**2).sum(axis=1)
    gain = np.maximum(gain, 0.0)
    plateau = y.mean() - gain * x.mean(axis=1)
    without = plateau < 0
    gain = np.where(without, x @ y / (x**2).sum(axis=1), gain)
    plateau = np.where(without, 0.0, plateau)
    squares = ((y - gain[:, None] * x - plateau[:, None]) ** 2).sum(axis=1)
    return gain, plateau, squares
