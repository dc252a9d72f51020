"""What the trials of a report vary by, taken from its rows."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from rastrainer.inference.variation import Trials, Variation, fit_variation, trade_off
from rastrainer.report.study_data import StudyData, TrialRow

TIME, ERROR, LAPSES = "completion_time_s", "rmse_mm", "undone_touches"


@dataclass(frozen=True)
class StudyVariation:
    """What time and RMSE of a study vary by.

    Attributes:
        trainees: Those who did every mode.
        trials: Theirs.
        time: Of the completion time.
        error: Of the RMSE.
        trade_off: k, and its standard error.
        lapses: Share of the trials in which a touch was taken back.
    """

    trainees: int
    trials: int
    time: Variation
    error: Variation
    trade_off: tuple[float, float]
    lapses: float


def study_variation(data: StudyData) -> StudyVariation | None:
    """Return what the trials vary by; None where the study cannot tell it, see `fit_variation`."""
    if not data.has_order:
        return None
    rows = _rows(data)
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
        for name in (TIME, ERROR)
    )
    if time is None or error is None:
        return None
    return StudyVariation(
        len(names), len(rows), time, error, trade_off(time, error), float(trials.lapses.mean())
    )


def _rows(data: StudyData) -> list[tuple[TrialRow, int]]:
    """Return the trials of those who did every mode, each with its number over all modes."""
    of_trainee: dict[str, list[TrialRow]] = defaultdict(list)
    for row in data.trials:
        of_trainee[row.trainee].append(row)
    return [
        (row, number)
        for own in of_trainee.values()
        if {row.mode for row in own} == set(data.modes)
        for number, row in enumerate(own, start=1)
        # A logarithm needs more than 0, as times and errors are.
        if min(row.values.get(TIME, 0.0), row.values.get(ERROR, 0.0)) > 0
    ]
