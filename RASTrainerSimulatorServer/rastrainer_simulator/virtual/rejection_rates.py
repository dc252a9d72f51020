"""How often the report's tests reject and its intervals cover, in many simulated studies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.report.elements.comparisons import CONFIRMATORY
from rastrainer.statistics.crossover import fit_differences, is_separable
from rastrainer.statistics.intervals import ALPHA
from rastrainer.statistics.paired import holm, rank_test
from rastrainer.statistics.scipy_modules import scipy_module
from rastrainer_simulator.virtual.outcome_model import (
    OutcomeModel,
    draw_outcomes,
    expected_outcomes,
    model_scores,
)


@dataclass(frozen=True)
class RejectionRates:
    """Of one outcome over many studies: false positives without a true effect, power with one.

    Attributes:
        outcome: One of those that the report tests.
        t_test: Share with p < .05 by the t-test, with the period where the orders allow it.
        holm: Share that holds after the correction for all outcomes.
        ranks: Share with p < .05 by the rank test.
        coverage: Share whose 95 % interval holds the true difference; None for the score, whose
            true difference is not in the model.
        true_difference: Mean difference that very many trainees have, second mode minus first,
            their order apart; None for the score.
    """

    outcome: str
    t_test: float
    holm: float
    ranks: float
    coverage: float | None
    true_difference: float | None


def rejection_rates(
    model: OutcomeModel,
    trainees: int,
    modes: Sequence[str],
    studies: int,
    seed: int,
    orders: Sequence[Sequence[str]] | None = None,
) -> tuple[RejectionRates, ...]:
    """Return the rates for two modes, tested on trainee means as the report does it.

    Args:
        model: The truth.
        trainees: Of each study.
        modes: Two.
        studies: How many to draw.
        seed: Of the draws.
        orders: The modes in the order of each trainee; by default that of `modes` for all.
    """
    random = np.random.default_rng(seed)
    drawn = [draw_outcomes(model, trainees, modes, random, orders) for _ in range(studies)]
    times, errors = (np.array(values) for values in zip(*drawn, strict=True))
    outcomes = (times, errors, model_scores(model, times, errors))
    delays = _delays(trainees, modes, orders)
    fits, differences = [], []
    for values in outcomes:
        own = np.diff(values.mean(axis=-1))[..., 0]
        differences.append(own)
        fits.append(fit_differences(own, delays))
    students = scipy_module("stats").t
    p_values = np.stack(
        [2 * students.sf(np.abs(fit.mean / fit.standard_error), fit.dof) for fit in fits], axis=-1
    )
    adjusted = holm(p_values)
    truths = [means.mean(axis=1) for means in expected_outcomes(model, modes)]
    found = []
    for index, outcome in enumerate(CONFIRMATORY):
        fit, truth, coverage = fits[index], None, None
        if index < len(truths):
            truth = float(truths[index][1] - truths[index][0])
            reach = students.ppf(1 - ALPHA / 2, fit.dof) * fit.standard_error
            coverage = float(np.mean(np.abs(fit.mean - truth) <= reach))
        tests = [rank_test(row, delays) for row in differences[index]]
        # What cannot be tested is never rejected.
        ranks = [1.0 if test is None else test.p for test in tests]
        found.append(
            RejectionRates(
                outcome=outcome,
                t_test=float(np.mean(p_values[:, index] < ALPHA)),
                holm=float(np.mean(adjusted[:, index] < ALPHA)),
                ranks=float(np.mean(np.array(ranks) < ALPHA)),
                coverage=coverage,
                true_difference=truth,
            )
        )
    return tuple(found)


def _delays(
    trainees: int, modes: Sequence[str], orders: Sequence[Sequence[str]] | None
) -> np.ndarray | None:
    """Return by how many periods each trainee does the second mode later; None if not separable."""
    orders = orders or [tuple(modes)] * trainees
    delays = np.array([float(own.index(modes[1]) - own.index(modes[0])) for own in orders])
    return delays if is_separable(delays) else None
