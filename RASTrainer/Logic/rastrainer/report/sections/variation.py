"""Sources of variation of the trials: practice, speed, trainees and modes."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from rastrainer.number_text import fixed, percent
from rastrainer.report.elements.markup import Cell, Line, paragraph, section, table
from rastrainer.report.sections.paired_statistics import interval_text
from rastrainer.statistics.intervals import CONFIDENCE
from rastrainer.statistics.scipy_modules import scipy_module
from rastrainer.statistics.variation import Trials, Variation, fit_variation, trade_off
from rastrainer.study.outcomes import mode_title
from rastrainer.study.study_data import StudyData, TrialRow

TIME, ERROR, LAPSES = "completion_time_s", "rmse_mm", "undone_touches"


@dataclass(frozen=True)
class StudyVariation:
    """Sources of variation of time and RMSE.

    Attributes:
        trainees: Number who did every mode.
        trials: Number of their trials.
        time: Of the completion time.
        error: Of the RMSE.
        trade_off: k, and its standard error.
        lapses: Share of the trials with an undone touch.
    """

    trainees: int
    trials: int
    time: Variation
    error: Variation
    trade_off: tuple[float, float]
    lapses: float


def study_variation(data: StudyData) -> StudyVariation | None:
    """Return the sources of variation; None as in `fit_variation`."""
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
    """Return the trials of those who did every mode, numbered over all modes."""
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


HEADER: Line = [Cell("Source of variation", kind="text"), "completion time", "RMSE"]


def variation(data: StudyData) -> str:
    """Return a table if the trials allow it; else ""."""
    found = study_variation(data)
    if found is None:
        return ""
    both, modes = (found.time, found.error), sorted(data.modes)
    reaches = [_reach(one.dof) for one in both]
    exponents = [
        _exponent(one.learning, reach * one.learning_error)
        for one, reach in zip(both, reaches, strict=True)
    ]
    k, error = found.trade_off
    rows = [
        ["Trials, trainees (n)", *[f"{found.trials}, {found.trainees}"] * 2],
        ["Practice: exponent b, the m-th trial of all in proportion to m^−b [95 %]", *exponents],
        [
            "Speed and accuracy: exponent k, RMSE in proportion to time^−k [95 %]",
            "–",
            _exponent(k, reaches[1] * error),
        ],
        *(
            [f"{mode_title(mode)} against {mode_title(modes[0])}"]
            + [_factor(one.modes[index]) for one in both]
            for index, mode in enumerate(modes)
            if index
        ),
        ["Between trainees (SD)", *(_sd(one.trainee_variance) for one in both)],
        ["Trainee × mode (SD)", *(_sd(one.interaction_variance) for one in both)],
        ["From trial to trial (SD)", *(_sd(one.trial_variance) for one in both)],
        [
            "Trials with a touch taken back against others",
            *("–" if one.lapse is None else _factor(one.lapse) for one in both),
        ],
    ]
    return section(
        "What completion time and error vary with",
        table([HEADER], [[Cell(row[0], kind="text"), *row[1:]] for row in rows], "wide"),
        paragraph(_words(found), "small"),
    )


def _reach(dof: int) -> float:
    return float(scipy_module("stats").t.ppf((1 + CONFIDENCE) / 2, dof))


def _exponent(value: float, reach: float) -> str:
    return interval_text(value, (value - reach, value + reach), 3)


def _sd(variance: float) -> str:
    """Return a standard deviation of logarithms in percent."""
    return percent(math.sqrt(max(variance, 0.0)))


def _factor(logarithm: float) -> str:
    return f"× {fixed(math.exp(logarithm), 2)}"


def _words(found: StudyVariation) -> str:
    return (
        f"{found.trials} trials of the {found.trainees} trainees who did every mode; a touch was "
        f"taken back in {percent(found.lapses)} of them. Logarithms, regressed on the trial’s "
        "number over all modes, the task, and one level for each trainee in each mode. SD are of "
        "logarithms: 10 % is about a tenth of the value. The intervals assume that all trainees "
        "learn alike, and the exponent that practice in one mode counts in the next; where all did "
        "the tasks in the same order, practice is told from difficulty only by the shape of its "
        "curve."
    )
