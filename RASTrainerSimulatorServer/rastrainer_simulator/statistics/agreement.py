"""How far raters agree: intraclass correlations of totals, weighted kappa of marks."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from rastrainer.errors import InputError
from rastrainer_simulator.statistics.intervals import TAIL, coefficient

FEWEST = 3
"""The agreement on two rated objects cannot be computed."""
DRAWS = 10_000
"""For the limits of an intraclass correlation; they are then exact to about 0.01."""

_Number = TypeVar("_Number", float, np.ndarray)


@dataclass(frozen=True)
class Agreement:
    """A coefficient, 1 if raters always agree, 0 if by chance only, and its 95 % interval."""

    value: float
    interval: tuple[float, float] | None


@dataclass(frozen=True)
class IntraclassCorrelations:
    """Absolute agreement of raters who stand for others like them (two-way random effects).

    How far a single rater can be relied on is ICC(2,1); the mean of these raters, ICC(2,k).
    """

    objects: int
    raters: int
    single: Agreement
    average: Agreement


def intraclass_correlations(ratings: np.ndarray) -> IntraclassCorrelations:
    """Return the agreement of (n, k) float ratings: n objects by k raters.

    The coefficients are defined by Shrout and Fleiss (1979). Their 95 % limits are generalized
    confidence limits (Weerahandi 1993): the limits of McGraw and Wong (1996, table 7) hold the
    truth in as few as 75 % of simulated studies if raters differ as much as objects; see
    Testing/error_rates/tables.md. Raters who differ by nothing but a constant leave no limits.
    """
    ratings = np.asarray(ratings, dtype=float)
    n, k = ratings.shape
    if n < FEWEST or k < 2:
        raise InputError("Agreement needs two raters who have rated the same three objects.")
    mean = ratings.mean()
    objects, raters = ratings.mean(axis=1), ratings.mean(axis=0)
    rows = k * float(np.sum((objects - mean) ** 2)) / (n - 1)
    columns = n * float(np.sum((raters - mean) ** 2)) / (k - 1)
    rest = ratings - objects[:, None] - raters[None, :] + mean
    error = float(np.sum(rest**2)) / ((n - 1) * (k - 1))
    # Rounding errors are not estimated from.
    least = 1e-12 * max(1.0, float(np.ptp(ratings)) ** 2)
    if rows < least:
        raise InputError("On average, all objects were rated the same: agreement is undefined.")
    value = _single(n, k, rows, columns, error)
    interval = of_mean = None
    if error >= least:
        interval = low, high = _limits(n, k, rows, columns, error)
        of_mean = _of_mean(low, k), _of_mean(high, k)
    average = Agreement(_of_mean(value, k), of_mean)
    return IntraclassCorrelations(n, k, Agreement(value, interval), average)


def _limits(n: int, k: int, rows: float, columns: float, error: float) -> tuple[float, float]:
    """Return the limits of ICC(2,1) from the mean squares of objects, raters and rest.

    Each mean square, times its degrees of freedom, is its expected value times a χ²: divided by
    drawn χ², the three give values of the coefficient that the data allow.
    """
    dofs = (n - 1, k - 1, (n - 1) * (k - 1))
    random = np.random.default_rng(0)
    rows_, columns_, error_ = (
        square * dof / random.chisquare(dof, DRAWS)
        for square, dof in zip((rows, columns, error), dofs, strict=True)
    )
    low, high = np.quantile(_single(n, k, rows_, columns_, error_), (TAIL, 1.0 - TAIL))
    return float(low), float(high)


def _single(n: int, k: int, rows: _Number, columns: _Number, error: _Number) -> _Number:
    return (rows - error) / (rows + (k - 1) * error + k * (columns - error) / n)


def _of_mean(value: float, k: int) -> float:
    """Return the agreement of the mean of k raters from a single rater's (Spearman and Brown)."""
    below = 1 + (k - 1) * value
    # Below −1/(k − 1), the mean of the raters means nothing.
    return k * value / below if below > 0 else -math.inf


def quadratic_kappa(first: np.ndarray, second: np.ndarray, lowest: int, highest: int) -> Agreement:
    """Return Cohen's kappa with quadratic weights of (n,) int marks of two raters.

    Its 95 % limits are the jackknife's on the scale of Fisher's z, by Student's t with n − 1
    degrees of freedom. The large-sample limits (Fleiss, Cohen and Everitt 1969) hold the truth of
    ten objects in 81 to 86 % of simulated studies only; see Testing/error_rates/tables.md.
    """
    first, second = np.asarray(first, dtype=int), np.asarray(second, dtype=int)
    n, marks = len(first), highest - lowest + 1
    if n < FEWEST:
        raise InputError("Agreement needs three objects that both raters have rated.")
    apart = np.subtract.outer(np.arange(marks), np.arange(marks))
    weights = 1.0 - (apart / (marks - 1)) ** 2
    table = np.zeros((marks, marks))
    np.add.at(table, (first - lowest, second - lowest), 1.0)
    value = kappa_of_table(table, weights)
    without = []
    for own, other in zip(first - lowest, second - lowest, strict=True):
        table[own, other] -= 1.0
        try:
            without.append(kappa_of_table(table, weights))
        except InputError:
            # Only one mark is left, which leaves no limits either.
            without.append(1.0)
        table[own, other] += 1.0
    if max(value, *without) >= 1.0 - 1e-12:
        return Agreement(value, None)
    z = np.arctanh(without)
    error = math.sqrt((n - 1) / n * float(np.sum((z - z.mean()) ** 2)))
    low, high = coefficient(math.atanh(value), error, n - 1).interval
    return Agreement(value, (math.tanh(low), math.tanh(high)))


def kappa_of_table(table: np.ndarray, weights: np.ndarray) -> float:
    """Return a weighted kappa (Cohen 1968).

    The (m, m) table has how many objects, or which share, have each pair of marks; the (m, m)
    weights are 1 where the marks are equal.
    """
    shares = table / table.sum()
    observed = float(np.sum(weights * shares))
    by_chance = float(shares.sum(axis=1) @ weights @ shares.sum(axis=0))
    if by_chance >= 1.0 - 1e-12:
        raise InputError(
            "Both raters gave every object the same mark: agreement cannot be computed."
        )
    return (observed - by_chance) / (1 - by_chance)
