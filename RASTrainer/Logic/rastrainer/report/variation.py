"""Sources of variation of the trials: practice, speed, trainees, modes, and bias of the views."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from rastrainer.number_text import counted, fixed
from rastrainer.report import page
from rastrainer.report.paired_statistics import interval_text
from rastrainer.statistics.intervals import Estimate, Proportion, mean, proportion
from rastrainer.statistics.variation import (
    MIN_TRAINEES,
    Trials,
    Variation,
    fit_variation,
    trade_off,
)
from rastrainer.study.outcomes import mode_title
from rastrainer.study.study_data import StudyData, TrialRow
from rastrainer.study.tre_calibration import share_text

TIME, ERROR, LAPSES = "completion_time_s", "rmse_mm", "undone_touches"


@dataclass(frozen=True)
class StudyVariation:
    """Sources of variation of time and RMSE.

    Attributes:
        trade_off: k.
    """

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
    lapses = proportion(int(trials.lapses.sum()), len(rows))
    return StudyVariation(len(names), len(rows), time, error, trade_off(time, error), lapses)


@dataclass(frozen=True)
class ViewBias:
    """By how much a view displaces the target, beyond what the residuals say.

    Attributes:
        squared: Of the displacement, mm²; below 0 by chance where it is about 0.
    """

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


HEADER: page.Line = [page.text("Source of variation [95 %]"), "n", "completion time", "RMSE"]
BIAS_HEADER: page.Line = [
    page.text("View"),
    "n, trials",
    "n, trainees",
    "displacement of the target, mm [95 %]",
]


def variation(data: StudyData) -> str:
    """Return the tables that the trials allow; "" if none."""
    found = study_variation(data)
    biases = {mode: view_bias(data, mode) for mode in sorted(data.modes)}
    parts = [] if found is None else _sources(found, sorted(data.modes))
    parts += _view_biases({mode: bias for mode, bias in biases.items() if bias is not None})
    return page.section("What completion time and error vary with", *parts) if parts else ""


def _sources(found: StudyVariation, modes: list[str]) -> list[str]:
    both = (found.time, found.error)
    trials, trainees = counted(found.trials, "trial"), counted(found.trainees, "trainee")
    practice = "Practice: exponent b, the m-th trial of all in proportion to m⁻ᵇ"
    speed = "Speed and accuracy: exponent k, RMSE in proportion to time⁻ᵏ"
    rows: list[page.Line] = [
        [practice, trials, *(_exponent(one.learning) for one in both)],
        [speed, trials, "–", _exponent(found.trade_off)],
        *(
            [f"{mode_title(mode)} against {mode_title(modes[0])}", trainees, *map(_factor, both)]
            for mode, *both in zip(modes[1:], found.time.modes, found.error.modes, strict=True)
        ),
        ["Between trainees (SD)", trainees, *(_sd(one.trainee_variance) for one in both)],
        ["Trainee × mode (SD)", trainees, *(_sd(one.interaction_variance) for one in both)],
        ["From trial to trial (SD)", trials, *(_sd(one.trial_variance) for one in both)],
        [
            "Trials with an undone touch against others",
            f"{found.lapses.count} of {found.trials}",
            *("–" if one.lapse is None else _factor(one.lapse) for one in both),
        ],
        [
            "Trials with an undone touch (share)",
            trials,
            page.Cell(share_text(found.lapses), span=2),
        ],
    ]
    return [page.table([HEADER], rows, "wide"), page.paragraph(_words(found), "small")]


def _view_biases(biases: dict[str, ViewBias]) -> list[str]:
    if not biases:
        return []
    rows: list[page.Line] = []
    for mode, bias in biases.items():
        low, high = map(_root, bias.squared.interval)
        length = interval_text(_root(bias.squared.value), (low, high), 2)
        rows.append([mode_title(mode), str(bias.trials), str(bias.trainees), length])
    return [
        page.heading("Bias of the views"),
        page.table([BIAS_HEADER], rows),
        page.paragraph(BIAS_WORDS, "small"),
    ]


BIAS_WORDS = (
    "By how much an offset that the touches of a trial share displaces the target: the root of the "
    "mean of true TRE² minus what the residuals say about its scatter. No registration error shows "
    "such an offset; the simulator knows where the head is. It may come from the view, or from "
    "what trainees have in common. The interval is that of the means of trainees (t); 0 stands for "
    "a mean below 0."
)


def _exponent(found: Estimate) -> str:
    return interval_text(found.value, found.interval, 3)


def _sd(found: Estimate) -> str:
    """Return a standard deviation of logarithms in percent, with its interval."""
    low, high = (100 * _root(limit) for limit in found.interval)
    return f"{fixed(100 * _root(found.value), 1)} % [{fixed(low, 1)}, {fixed(high, 1)}]"


def _factor(found: Estimate) -> str:
    low, high = (math.exp(limit) for limit in found.interval)
    return f"× {interval_text(math.exp(found.value), (low, high), 2)}"


def _root(square: float) -> float:
    return math.sqrt(max(square, 0.0))


def _words(found: StudyVariation) -> str:
    return (
        f"{found.trials} trials of the {found.trainees} trainees who did every mode. Logarithms, "
        "regressed on the trial’s number over all modes, the task, and one level for each "
        "trainee in each mode. SD are of logarithms: 10 % is about a tenth of the value; 0 "
        "stands for a variance below 0. Their intervals are those of mean squares (χ²; Burdick "
        "and Graybill 1992), that of the share is Wilson’s (1927), the others are of t. They "
        "assume that trainees learn and slip alike; the exponent also, that practice in one mode "
        "counts in the next. Where all did the tasks in the same order, practice can be "
        "distinguished from difficulty only by the shape of its curve."
    )
