"""The methods of registration side by side: residual, expected and true target error.

Also what a shift of the skin did: the true errors next to those of the same trials without it.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rastrainer.number_text import fixed, p_text
from rastrainer.protocol import RegistrationMethod
from rastrainer.report import page
from rastrainer.report.comparisons import ModeComparison, compare_modes, tested, with_adjusted_p
from rastrainer.report.mode_comparison import Series, grouped_bars
from rastrainer.report.paired_statistics import interval_text, what_it_shows
from rastrainer.statistics.intervals import mean
from rastrainer.study.outcomes import Outcome
from rastrainer.study.study_data import StudyData, TrialRow, values_of

TITLES = {
    RegistrationMethod.FIDUCIALS.value: "Fiducials",
    RegistrationMethod.LANDMARKS.value: "Landmarks",
    RegistrationMethod.SURFACE.value: "Trace",
    RegistrationMethod.LANDMARKS_SURFACE.value: "Landmarks and trace",
}
RESIDUAL = Outcome("rmse_mm", "Residual", unit="mm")
EXPECTED = Outcome("expected_tre_mm", "Expected target error", unit="mm", better=-1)
TRUE = Outcome("true_tre_mm", "True target error", unit="mm", better=-1)
OUTCOMES = (RESIDUAL, EXPECTED, TRUE)
COLORS = {RESIDUAL: "#6b7785", EXPECTED: "#0b6fa4", TRUE: "#d1661b"}
INTRO = (
    "Residuals of different methods are of different points: a small residual does not mean a "
    "small error, and does not show which method is better. The true target error does."
)
PAIRED = (
    "Each trainee counts once, with the mean over the modes in which both methods were played; "
    "differences are the second method minus the first, free of the effect of the period where "
    "the orders allow it. The decision is about the true error alone, with Holm's correction over "
    "the pairs of methods; the other outcomes are described. What else differed between the "
    "trials, such as their tasks, is part of the differences."
)
_HEADER = (
    *("Method", "n, trainees", "trials", "residual (mm) [95 %]", "expected TRE (mm) [95 %]"),
    *("true TRE (mm) [95 %]", "true inside"),
)
_PAIR_HEADER = ("Outcome", "first", "second", "n", "difference [95 %]", "t", "p", "p (Holm)")
SKIN_INTRO = (
    "In these trials the skin lay otherwise than in the images. Residual and expected error show "
    "little of it. The last column is of the same points, put back to where they would have been "
    "measured and registered again; means over the trials whose truth was revealed."
)
SKIN_HEADER = (
    *("Shift, RMS (mm)", "indentation (mm)", "registered by", "trials", "residual (mm)"),
    *("expected TRE (mm)", "true TRE (mm)", "without the shift (mm)"),
)


def method_comparison(data: StudyData) -> str:
    """Return the section; "" where all trials were registered by one method."""
    by_method = as_conditions(data)
    methods = [name for name in TITLES if name in by_method.modes]
    if len(methods) < 2:
        return ""
    pairs = compare_methods(by_method)
    parts = [
        page.paragraph(INTRO),
        page.table([_HEADER], [_row(by_method, each) for each in methods], "wide"),
    ]
    parts.append(
        page.figure([_picture(by_method, methods)], "Every trial at the scenario's target.")
    )
    if pairs:
        parts += [
            page.heading("Differences between methods"),
            page.paragraph(PAIRED),
            page.bullets(_findings(pairs)),
            page.table([_PAIR_HEADER], [_pair_row(each) for each in pairs], "wide"),
        ]
    else:
        parts.append(
            page.paragraph("No trainee played two methods in one mode: nothing is tested.")
        )
    return page.section("Methods of registration", *parts)


def as_conditions(data: StudyData) -> StudyData:
    trials = tuple(replace(each, mode=each.method, task=each.mode) for each in data.trials)
    return replace(data, trials=trials)


def compare_methods(by_method: StudyData) -> tuple[ModeComparison, ...]:
    """Compare each two methods on residual, expected and true error.

    The p of the true errors are adjusted together (Holm); the others are only described.

    Args:
        by_method: As from `as_conditions`.
    """
    names = [name for name in TITLES if name in by_method.modes]
    found = [
        comparison
        for first, second in itertools.combinations(names, 2)
        for comparison in compare_modes(by_method, OUTCOMES, first, second, confirmatory=())
    ]
    return with_adjusted_p(found, (TRUE.name,))


def _findings(pairs: Sequence[ModeComparison]) -> list[str]:
    sentences = [
        what_it_shows(
            f"True target error ({TITLES[each.first].lower()} and {TITLES[each.second].lower()})",
            each.outcome.unit,
            TITLES[each.first].lower(),
            TITLES[each.second].lower(),
            result,
            each.adjusted_p,
            each.outcome.digits,
            "pairs of methods",
        )
        for each, result in tested(pairs)
        if each.adjusted_p is not None
    ]
    return sentences or ["The true errors of too few trainees are known: nothing is tested."]


def _row(by_method: StudyData, method: str) -> page.Line:
    trials = by_method.of_mode(method)
    trainees = {trial.trainee for trial in trials}
    means = [_mean_text(trials, outcome) for outcome in OUTCOMES]
    held = [
        values["tre_low_mm"] <= values["true_tre_mm"] <= values["tre_high_mm"]
        for values in (trial.values for trial in trials)
        if {"tre_low_mm", "true_tre_mm"} <= set(values)
    ]
    inside = f"{sum(held)} of {len(held)}" if held else "–"
    return [TITLES[method], str(len(trainees)), str(len(trials)), *means, inside]


def _mean_text(trials: Sequence[TrialRow], outcome: Outcome) -> str:
    """Return the mean of the trainees' means with its interval."""
    own: dict[str, list[float]] = {}
    for trial in trials:
        if outcome.name in trial.values:
            own.setdefault(trial.trainee, []).append(trial.values[outcome.name])
    if not own:
        return "–"
    means = np.array([float(np.mean(values)) for values in own.values()])
    if len(means) < 2:
        return outcome.text(float(means.mean()))
    estimate = mean(means)
    return interval_text(estimate.value, estimate.interval, outcome.digits)


def _picture(by_method: StudyData, methods: Sequence[str]) -> str:
    series = [
        Series(
            outcome.title,
            color,
            tuple(tuple(values_of(by_method.of_mode(method), outcome.name)) for method in methods),
        )
        for outcome, color in COLORS.items()
    ]
    names = [TITLES[method] for method in methods]
    return grouped_bars("Residual and target error, mm", names, series, "method")


def _pair_row(pair: ModeComparison) -> page.Line:
    outcome, result = pair.outcome, pair.result
    start: page.Line = [outcome.heading, TITLES[pair.first], TITLES[pair.second]]
    start = [*start, str(len(pair.trainees))]
    if result is None:
        return [*start, page.Cell(pair.reason, 4, kind="text")]
    return [
        *start,
        interval_text(result.mean_difference, result.interval, outcome.digits),
        fixed(result.t, 2),
        p_text(result.p),
        "–" if pair.adjusted_p is None else p_text(pair.adjusted_p),
    ]


def shifted_skin(data: StudyData) -> str:
    """Return the section; "" where the skin lay as in the images in all trials."""
    groups: dict[tuple[float, float, str], list[TrialRow]] = {}
    for trial in data.trials:
        if "skin_shift_mm" in trial.values:
            amounts = trial.values["skin_shift_mm"], trial.values["skin_indentation_mm"]
            groups.setdefault((*amounts, trial.method), []).append(trial)
    if not groups:
        return ""
    names = ("rmse_mm", "expected_tre_mm", "true_tre_mm", "unshifted_tre_mm")
    rows = [
        [
            *(fixed(shift, 1), fixed(indentation, 1), TITLES.get(method, method), str(len(trials))),
            *(
                fixed(float(np.mean(values)), 2) if (values := values_of(trials, name)) else "–"
                for name in names
            ),
        ]
        for (shift, indentation, method), trials in sorted(groups.items())
    ]
    return page.section(
        "Shifted skin", page.paragraph(SKIN_INTRO), page.table([SKIN_HEADER], rows, "wide")
    )
