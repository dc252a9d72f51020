"""What the trials vary by: practice, haste, trainees and modes."""

from __future__ import annotations

import math

from rastrainer.inference.effect_size import CONFIDENCE
from rastrainer.number_text import fixed, percent
from rastrainer.report.markup import Cell, paragraph, section, table
from rastrainer.report.outcomes import mode_title
from rastrainer.report.sections.paired_statistics import interval_text
from rastrainer.report.study_data import StudyData
from rastrainer.report.study_variation import StudyVariation, study_variation
from rastrainer.scipy_modules import scipy_module

HEADER = [Cell("Source of variation", kind="text"), "completion time", "RMSE"]


def variation(data: StudyData) -> str:
    """Return a table for a study whose trials can tell it; otherwise nothing."""
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
