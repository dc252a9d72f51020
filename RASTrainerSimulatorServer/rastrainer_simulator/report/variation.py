"""Sources of variation of the trials: practice, speed, trainees, modes, and bias of the views."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from rastrainer.registration.distributions import Proportion, proportion
from rastrainer.study.study_data import StudyData
from rastrainer.trial.ctps import RMSE, TIME
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.report.page import interval_text, render
from rastrainer_simulator.statistics.intervals import Estimate, mean
from rastrainer_simulator.statistics.variation import (
    MIN_TRAINEES,
    Trials,
    Variation,
    fit_variation,
    trade_off,
)

LAPSES = "undone_touches"


@dataclass(frozen=True)
class StudyVariation:
    """Sources of variation of time and RMSE."""

    trainees: int
    trials: int
    time: Variation
    error: Variation
    trade_off: Estimate
    lapses: Proportion


def study_variation(data: StudyData) -> StudyVariation | None:
    """Return the sources of variation; None as in `fit_variation`."""
    if not data.has_order:
        return None
    of_trainee: dict[str, list[TrialRow]] = defaultdict(list)
    for row in data.trials:
        of_trainee[row.trainee].append(row)
    # Trials of those who did every mode, numbered over all modes.
    rows = [
        (row, number)
        for own in of_trainee.values()
        if {row.mode for row in own} == set(data.modes)
        for number, row in enumerate(own, start=1)
        # A logarithm needs more than 0, as times and errors are.
        if min(row.values.get(TIME, 0.0), row.values.get(RMSE, 0.0)) > 0
    ]
    if not rows:
        return None
    names = sorted({row.trainee for row, _number in rows})
    modes, tasks = sorted(data.modes), data.tasks
    trials = Trials(
        trainees=np.array([names.index(row.trainee) for row, _number in rows]),
        modes=np.array([modes.index(row.mode) for row, _number in rows]),
        tasks=np.array([tasks.index(row.task) for row, _number in rows]),
        numbers=np.array([number for _row, number in rows]),
        lapses=np.array([float(row.values.get(LAPSES, 0) > 0) for row, _number in rows]),
    )
    time, error = (
        fit_variation(trials, np.array([row.values[name] for row, _number in rows]))
        for name in (TIME, RMSE)
    )
    if time is None or error is None:
        return None
    lapses = proportion(int(trials.lapses.sum()), len(rows))
    return StudyVariation(len(names), len(rows), time, error, trade_off(time, error), lapses)


@dataclass(frozen=True)
class ViewBias:
    """The square of the displacement of the target by a view that residuals do not show, mm²."""

    trainees: int
    trials: int
    squared: Estimate


def view_bias(data: StudyData, mode: str) -> ViewBias | None:
    """Return the bias of a mode's view; None with fewer than four trainees.

    The mean of true TRE² minus the part of the expected TRE² that the residuals explain: an offset
    common to all touches adds its square to the first and leaves the second. Trainees count alike,
    and their scatter gives the interval.
    """
    own: dict[str, list[float]] = defaultdict(list)
    for trial in data.of_mode(mode):
        values = trial.values
        if "true_tre_mm" in values and "expected_tre_mm" in values:
            assumed = 3 * values.get("tre_common_bias_sd_mm", 0.0) ** 2
            scatter = values["expected_tre_mm"] ** 2 - assumed
            own[trial.trainee].append(values["true_tre_mm"] ** 2 - scatter)
    if len(own) < MIN_TRAINEES:
        return None
    means = np.array([np.mean(excess) for excess in own.values()])
    return ViewBias(len(own), sum(map(len, own.values())), mean(means))


def variation(data: StudyData) -> Markup:
    """Return the tables that the trials allow; "" if none."""
    found = study_variation(data)
    modes = sorted(data.modes)
    biases = {mode: bias for mode in modes if (bias := view_bias(data, mode)) is not None}
    if found is None and not biases:
        return Markup()
    return render(
        "variation",
        found=found,
        modes=modes,
        biases=biases,
        factor=lambda found: "× " + interval_text(found.mapped(math.exp), 2),
        sd=lambda found: interval_text(found.mapped(lambda x: 100 * max(x, 0.0) ** 0.5), 1, " %"),
        length=lambda found: interval_text(found.mapped(lambda x: max(x, 0.0) ** 0.5), 2),
    )
