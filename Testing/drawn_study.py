"""A whole study drawn from the model of outcomes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rastrainer.study.study_data import StudyData
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.virtual.outcome_model import (
    OutcomeModel,
    draw,
    model_scores,
    trial_numbers,
)
from rastrainer_simulator.virtual.population import pseudonym


def draw_study(
    model: OutcomeModel,
    trainees: int,
    modes: Sequence[str],
    random: np.random.Generator,
    orders: Sequence[Sequence[str]] | None = None,
) -> StudyData:
    """Return a study in which every trainee does every task once in every mode.

    `orders` has the order of the modes for each trainee, by default `modes` for all.
    """
    orders = orders or [tuple(modes)] * trainees
    numbers = trial_numbers(orders, modes, len(model.task_times_s))
    times, errors, _, _ = draw(model, modes, random, numbers)
    scores = model_scores(model, times, errors)
    rows = [
        TrialRow(
            pseudonym(i),
            mode,
            f"task-{k + 1}",
            k + 1,
            {
                "completion_time_s": float(times[i, m, k]),
                "rmse_mm": float(errors[i, m, k]),
                "score": float(scores[i, m, k]),
            },
            started_utc=f"2026-05-{orders[i].index(mode) + 1:02d}T09:{k:02d}:00Z",
        )
        for i in range(trainees)
        for mode, m in sorted(
            ((mode, m) for m, mode in enumerate(modes)), key=lambda one: orders[i].index(one[0])
        )
        for k in range(len(model.task_times_s))
    ]
    return StudyData("Simulated outcomes", tuple(rows), has_order=True)
