"""Probabilities for tests and intervals.

scipy is imported where it is used: opening the module in Slicer should not wait for it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from statistics import NormalDist

import numpy as np

DIRECTIONS = 12
"""Nodes of a quadrature over an octant, in each direction."""


def f_tail(value: float, numerator: float, denominator: float) -> float:
    """Return the probability that an F variable exceeds `value`."""
    from scipy import special

    return float(special.fdtrc(numerator, denominator, value))


def ratio_quantile(probability: float, weights: np.ndarray, dof: float) -> float:
    """Return the quantile of Σ wₖ zₖ² / (χ²/dof), zₖ standard normal, all independent.

    Equal weights give a multiple of the F distribution. Unequal weights describe the squared length
    of a vector of anisotropic variance whose size was estimated from `dof` residuals.

    P(Σ wₖ zₖ² − value·χ²/dof ≤ 0) follows from Imhof's inversion formula (1961). The integral runs
    over u = exp(s), where the trapezoidal rule converges exponentially. The weights, (k,) float,
    are above 0; `dof` are the degrees of freedom of the χ² variable.
    """
    scale, step = float(np.sum(weights)), 0.025
    u = np.exp(np.arange(-30.0, 30.0, step))
    terms = np.asarray(weights)[:, None] / scale * u
    angles = 0.5 * np.arctan(terms).sum(axis=0)
    log_sizes = 0.25 * np.log1p(terms**2).sum(axis=0)

    def probability_up_to(value: float) -> float:
        term = value / dof * u
        angle = angles - 0.5 * dof * np.arctan(term)
        log_size = log_sizes + 0.25 * dof * np.log1p(term**2)
        return 0.5 - step * float(np.sum(np.sin(angle) * np.exp(-log_size))) / math.pi

    return scale * _quantile(probability_up_to, probability, 1.0, 1e-8)


def widened_quantile(probability: float, weights: np.ndarray, dof: float, added: float) -> float:
    """Return the quantile of Σ (wₖ·dof/χ² + added) zₖ², zₖ standard normal, all independent.

    It is the squared length of a vector in space of two parts: one whose size was estimated from
    `dof` residuals, and one of known variance that is the same in all directions. Given χ² and the
    direction n of z, |z|² is χ² with 3 degrees of freedom; the mean over both is taken by
    quadrature. The weights, (3,) float, are not below 0; `dof` is infinite where the size is known;
    `added`, the known variance of each coordinate, is above 0 if the weights are 0.
    """
    probability_up_to = widened_distribution(weights, dof, added)
    return _quantile(probability_up_to, probability, float(np.sum(weights)) + 3.0 * added, 1e-7)


def widened_distribution(weights: np.ndarray, dof: float, added: float) -> Callable[[float], float]:
    """Return the probability up to a value of the sum of `widened_quantile`, as a function."""
    from scipy import special

    scales, shares = _inverse_chi_square(dof)
    squares, areas = _octant()
    # One row a direction, one column a size.
    variances = (squares @ np.asarray(weights, dtype=float))[:, None] * scales + added
    of_nodes = areas[:, None] * shares

    def probability_up_to(value: float) -> float:
        # The distribution function of χ² with 3 degrees of freedom.
        root = np.sqrt(value / (2.0 * variances))
        up_to = special.erf(root) - 2.0 / math.sqrt(math.pi) * root * np.exp(-(root**2))
        return float(np.sum(of_nodes * up_to))

    return probability_up_to


def _quantile(
    probability_up_to: Callable[[float], float], probability: float, guess: float, tolerance: float
) -> float:
    """Return, by bisection, the value above 0 up to which a distribution has a probability.

    `guess` is above 0, and `tolerance` is a share of the value.
    """
    low, high = 0.0, guess
    while probability_up_to(high) < probability:
        low, high = high, 4.0 * high
    while high - low > tolerance * high:
        middle = (low + high) / 2
        if probability_up_to(middle) < probability:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def _inverse_chi_square(dof: float) -> tuple[np.ndarray, np.ndarray]:
    """Return values of dof/χ² and their probabilities, which sum to 1.

    The trapezoidal rule over ln χ² converges exponentially.
    """
    if math.isinf(dof):
        return np.ones(1), np.ones(1)
    width = math.sqrt(2.0 / dof)
    y = math.log(dof) + width * np.linspace(-14.0 - 8.0 * width, 8.0, 49)
    logs = 0.5 * (dof * y - np.exp(y))
    densities = np.exp(logs - logs.max())
    kept = densities > 1e-12
    return dof * np.exp(-y[kept]), densities[kept] / densities[kept].sum()


@lru_cache(maxsize=1)
def _octant() -> tuple[np.ndarray, np.ndarray]:
    """Return the squared coordinates of directions in an octant, (m, 3), and their shares of it."""
    roots, root_weights = np.polynomial.legendre.leggauss(DIRECTIONS)
    height, turn = 0.5 * (roots + 1.0), (np.arange(DIRECTIONS) + 0.5) * math.pi / (2 * DIRECTIONS)
    across = 1.0 - height[:, None] ** 2
    squares = [across * np.cos(turn) ** 2, across * np.sin(turn) ** 2]
    squares.append(np.broadcast_to(height[:, None] ** 2, squares[0].shape))
    areas = np.repeat(root_weights / (2 * DIRECTIONS), DIRECTIONS)
    return np.stack(squares, axis=-1).reshape(-1, 3), areas


@dataclass(frozen=True)
class Proportion:
    """How many of how many, with the 95 % interval of the share."""

    count: int
    total: int
    interval: tuple[float, float]

    @property
    def share(self) -> float:
        return self.count / self.total


def proportion(count: int, total: int) -> Proportion:
    """Return a share with the interval by Wilson (1927).

    It stays within 0 and 1 and keeps its 95 % for shares near them, as `count ± 2 SE` does not. It
    takes the trials as independent.
    """
    z, share = NormalDist().inv_cdf(0.975), count / total
    middle = (share + z**2 / (2 * total)) / (1 + z**2 / total)
    reach = math.sqrt(share * (1 - share) / total + (z / (2 * total)) ** 2) * z / (1 + z**2 / total)
    return Proportion(count, total, (max(0.0, middle - reach), min(1.0, middle + reach)))
