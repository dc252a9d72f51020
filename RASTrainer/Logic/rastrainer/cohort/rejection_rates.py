"""How often tests reject and intervals cover in many simulated studies: power, or its lack."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.cohort.outcome_model import OutcomeModel, draw_outcomes, expected_outcomes
from rastrainer.inference.power import ALPHA
from rastrainer.inference.signed_ranks import signed_rank_test
from rastrainer.inference.student import t_quantile


@dataclass(frozen=True)
class RejectionRates:
    """Of one outcome over many studies.

    Attributes:
        outcome: `completion_time_s` or `rmse_mm`.
        studies: How many were drawn.
        t_test: Share with p < .05 by the paired t-test: false positives without a true effect,
            power with one.
        wilcoxon: The same by the signed-rank test.
        coverage: Share whose 95 % interval holds the true mean difference.
        true_difference: Mean difference that very many trainees have, second mode minus first.
    """

    outcome: str
    studies: int
    t_test: float
    wilcoxon: float
    coverage: float
    true_difference: float


def rejection_rates(
    model: OutcomeModel, trainees: int, modes: Sequence[str], studies: int, seed: int
) -> tuple[RejectionRates, ...]:
    """Return the rates of both outcomes for two modes, tested on trainee means.

    They are those of `compare_paired`, without its costly interval of the effect size.
    """
    random = np.random.default_rng(seed)
    truth = [means.mean(axis=1) for means in expected_outcomes(model, modes)]
    found = []
    critical = t_quantile(1 - ALPHA / 2, trainees - 1)
    drawn = [draw_outcomes(model, trainees, modes, random) for _ in range(studies)]
    for index, outcome in enumerate(("completion_time_s", "rmse_mm")):
        true_difference = float(truth[index][1] - truth[index][0])
        differences = np.array([np.diff(study[index].mean(axis=2))[:, 0] for study in drawn])
        means = differences.mean(axis=1)
        reach = critical * differences.std(axis=1, ddof=1) / np.sqrt(trainees)
        ranks = [signed_rank_test(row).p for row in differences]
        found.append(
            RejectionRates(
                outcome=outcome,
                studies=studies,
                t_test=float(np.mean(np.abs(means) > reach)),
                wilcoxon=float(np.mean(np.array(ranks) < ALPHA)),
                coverage=float(np.mean(np.abs(means - true_difference) <= reach)),
                true_difference=true_difference,
            )
        )
    return tuple(found)
