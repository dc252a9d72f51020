"""Several methods of registration on the same trainees: how often the report finds a difference."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import stats

from rastrainer_simulator.statistics.intervals import ALPHA
from rastrainer_simulator.statistics.paired import fit_differences, holm, is_separable
from Testing.error_rates.measured import Measured, share_of, share_text

HEADER = (
    "methods, trainees",
    "some p (Holm) < .05",
    "some p < .05",
    "coverage of the 95 % intervals",
)
BETWEEN, PRACTICE = 0.3, 0.15
"""SD of the trainees' logarithms; exponent by which practice reduces errors."""


class Decisions(NamedTuple):
    """Decisions on each pair of methods, arrays of shape (sets, pairs).

    Whether p, adjusted over the pairs, and p alone are below the level; and the ends of the
    interval of the mean difference.
    """

    adjusted: np.ndarray
    unadjusted: np.ndarray
    low: np.ndarray
    high: np.ndarray


def drawn_errors(
    factors: Sequence[float], trainees: int, sets: int, random: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Return true errors, (sets, trainees, methods) float, mm, and the place of each method.

    An error is the length of a vector whose three parts are normal. Trainees differ, practice
    reduces errors, and each method comes equally often at each place as far as it can.
    """
    count = len(factors)
    rows = [[(start + step) % count for step in range(count)] for start in range(count)]
    rows += [row[::-1] for row in rows]
    places = np.array([np.argsort(rows[index % len(rows)]) for index in range(trainees)])
    skill = np.exp(random.normal(0.0, BETWEEN, (sets, trainees, 1)))
    lengths = np.linalg.norm(random.normal(size=(sets, trainees, count, 3)), axis=-1)
    return np.array(factors) * skill * lengths * (1.0 + places) ** -PRACTICE, places


def decisions(errors: np.ndarray, places: np.ndarray) -> Decisions:
    """Analyze studies of `drawn_errors` as the report does."""
    found = []
    students = stats.t
    for first, second in itertools.combinations(range(errors.shape[-1]), 2):
        order = np.sign(places[:, second] - places[:, first]).astype(float)
        differences = errors[..., second] - errors[..., first]
        fit = fit_differences(differences, order if is_separable(order) else None)
        reach = students.ppf(0.975, fit.dof) * fit.standard_error
        p = 2 * students.sf(np.abs(fit.mean / fit.standard_error), fit.dof)
        found.append((p, fit.mean - reach, fit.mean + reach))
    p, low, high = (np.stack(each, axis=-1) for each in zip(*found, strict=True))
    return Decisions(holm(p) < ALPHA, p < ALPHA, low, high)


def differences(sets: int, seed: int = 31) -> list[Measured]:
    """Return how often any difference is found between methods, equal or not."""
    random = np.random.default_rng(seed)
    return [
        _case(count, trainees, factor, sets, random)
        for factor in (1.0, 2.0)
        for count in (2, 4)
        for trainees in (6, 12, 24)
    ]


def _case(
    count: int, trainees: int, factor: float, sets: int, random: np.random.Generator
) -> Measured:
    """Return the shares for methods of equal errors, or the last one `factor` times as large."""
    factors = (*[1.0] * (count - 1), factor)
    errors, places = drawn_errors(factors, trainees, sets, random)
    found = decisions(errors, places)
    differs = f"one {factor:g} times as inexact" if factor != 1.0 else "equally exact"
    coverage = "–"
    if factor == 1.0:
        coverage = share_text(share_of((found.low <= 0.0) & (found.high >= 0.0)))
    return Measured(
        f"{count} methods, {differs}, {trainees} trainees",
        share_of(found.adjusted.any(axis=-1)),
        sets,
        at_most=0.06 if factor == 1.0 else None,
        at_least=0.8 if factor != 1.0 and trainees == 24 else None,
        further=(share_text(share_of(found.unadjusted.any(axis=-1))), coverage),
    )
