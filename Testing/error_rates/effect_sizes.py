"""How often the interval of Hedges' gz holds the population's own effect size."""

from __future__ import annotations

import numpy as np

from rastrainer.statistics.crossover import fit_differences
from rastrainer.statistics.effect_size import small_sample_factor
from rastrainer.statistics.paired import compare_paired
from rastrainer.statistics.scipy_modules import scipy_module
from Testing.error_rates.measured import Measured, share_of, share_text

HEADER = (
    "paired trainees",
    "interval contains the truth",
    "limits multiplied by J (previous method)",
)
TRUTHS = (0.0, 0.5, 1.5)
MORE = 10
"""Times as many data sets as are asked for: a share of 95 % is to be told from 94 %."""
COMPUTED = 20
"""Of them, those whose interval is computed: to see whether t lies in its tails is the same."""


def coverage(sets: int, seed: int = 7) -> list[Measured]:
    """Return the coverage without an order, and of four and twelve in two sequences."""
    random = np.random.default_rng(seed)
    cases = [(n, truth, False) for n in (3, 4, 8, 20) for truth in TRUTHS]
    cases += [(4, 0.5, True), (12, 1.5, True)]
    return [_coverage(*case, MORE * sets, random) for case in cases]


def _coverage(
    n: int, truth: float, in_sequences: bool, sets: int, random: np.random.Generator
) -> Measured:
    order = np.where(np.arange(n) % 2, -1.0, 1.0) if in_sequences else None
    rows = random.normal(truth, 1.0, (sets, n)) + (2 * order if in_sequences else 0.0)
    fit = fit_differences(rows, order)
    held = _holds(fit.mean / fit.standard_error, fit.dof, truth * np.sqrt(n))
    for row, expected in zip(rows[:COMPUTED], held, strict=False):
        low, high = compare_paired(np.zeros(n), row, order).gz_interval
        assert (low <= truth <= high) == expected
    # Limits times J hold the truth where the limits hold the truth over J.
    shrunk = truth / small_sample_factor(fit.dof) * np.sqrt(n)
    before = share_of(_holds(fit.mean / fit.standard_error, fit.dof, shrunk))
    words = f"{n}, true effect {truth:g}" + (", two sequences" if in_sequences else "")
    return Measured(words, share_of(held), sets, at_least=0.94, beside=(share_text(before),))


def _holds(t: np.ndarray, dof: int, noncentrality: float) -> np.ndarray:
    """Return whether the interval of the noncentrality holds this one."""
    below = scipy_module("stats").nct.cdf(t, dof, noncentrality)
    # Far out in a tail, scipy gives no number.
    below = np.where(np.isnan(below), noncentrality < t, below)
    return (below >= 0.025) & (below <= 0.975)
