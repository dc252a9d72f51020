"""Expected and true target errors: calibration, methods of registration, shifted skin."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from markupsafe import Markup

from rastrainer.number_text import fixed
from rastrainer.protocol import RegistrationMethod
from rastrainer.registration.target_error import INTERVAL_NOTE
from rastrainer.study.outcomes import Outcome, mode_title, short_mode_title
from rastrainer.study.study_data import StudyData, values_of
from rastrainer.study.tre_calibration import calibration_of
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.report import charts
from rastrainer_simulator.report.comparisons import ModeComparison, compare_modes, with_adjusted_p
from rastrainer_simulator.report.page import interval_text, render
from rastrainer_simulator.statistics.intervals import mean

TITLES = {
    RegistrationMethod.FIDUCIALS.value: "Fiducials",
    RegistrationMethod.LANDMARKS.value: "Landmarks",
    RegistrationMethod.SURFACE.value: "Trace",
    RegistrationMethod.LANDMARKS_SURFACE.value: "Landmarks and trace",
}
RESIDUAL = Outcome("rmse_mm", "Residual", unit="mm")
EXPECTED = Outcome("expected_tre_mm", "Expected target error", unit="mm", better=-1)
TRUE = Outcome("true_tre_mm", "True target error", unit="mm", better=-1)
COLORS = {RESIDUAL: "#6b7785", EXPECTED: "#0b6fa4", TRUE: "#d1661b"}


def calibration(data: StudyData) -> Markup:
    """Return how well errors were expected; "" if no target errors are known."""
    found = calibration_of(data.trials)
    if not found.points and not found.without_truth:
        return Markup()
    colors = {
        mode: (short_mode_title(mode), charts.mode_color(mode, index))
        for index, mode in enumerate(data.modes)
        if found.of_mode(mode).points
    }
    parted = {mode_title(mode): found.of_mode(mode) for mode in colors}
    if len(parted) > 1:
        parted["all"] = found
    chart = charts.calibration_chart(found.points, colors) if found.points else None
    return render("calibration", found=found, parted=parted, chart=chart, note=INTERVAL_NOTE)


def method_comparison(data: StudyData) -> Markup:
    """Return the section; "" where all trials were registered by one method."""
    by_method = as_conditions(data)
    methods = [name for name in TITLES if name in by_method.modes]
    if len(methods) < 2:
        return Markup()
    series = [
        (
            outcome.title,
            color,
            [values_of(by_method.of_mode(name), outcome.name) for name in methods],
        )
        for outcome, color in COLORS.items()
    ]
    names = [TITLES[method] for method in methods]
    return render(
        "methods_of_registration",
        titles=TITLES,
        rows=[_row(by_method, method) for method in methods],
        chart=charts.grouped_bars("Residual and target error, mm", names, series, "method"),
        pairs=compare_methods(by_method),
    )


def as_conditions(data: StudyData) -> StudyData:
    trials = tuple(replace(each, mode=each.method, task=each.mode) for each in data.trials)
    return replace(data, trials=trials)


def compare_methods(by_method: StudyData) -> tuple[ModeComparison, ...]:
    """Compare each two methods of a study from `as_conditions` on residual and both errors.

    The p of the true errors are adjusted together (Holm); the others are only described.
    """
    names = [name for name in TITLES if name in by_method.modes]
    found = [
        comparison
        for first, second in itertools.combinations(names, 2)
        for comparison in compare_modes(by_method, tuple(COLORS), first, second, confirmatory=())
    ]
    return with_adjusted_p(found, (TRUE.name,))


def _row(by_method: StudyData, method: str) -> list[str]:
    trials = by_method.of_mode(method)
    held = calibration_of(trials).inside
    return [
        TITLES[method],
        str(len({trial.trainee for trial in trials})),
        str(len(trials)),
        *(_mean_text(trials, outcome) for outcome in COLORS),
        f"{held.count} of {held.total}" if held else "–",
    ]


def _mean_text(trials: Sequence[TrialRow], outcome: Outcome) -> str:
    own: dict[str, list[float]] = defaultdict(list)
    for trial in trials:
        if outcome.name in trial.values:
            own[trial.trainee].append(trial.values[outcome.name])
    means = np.array([float(np.mean(values)) for values in own.values()])
    if len(means) < 2:
        return outcome.text(means[0]) if len(means) else "–"
    return interval_text(mean(means), outcome.digits)


def shifted_skin(data: StudyData) -> Markup:
    """Return the section; "" if the skin was never shifted."""
    groups: dict[tuple[float, float, str], list[TrialRow]] = defaultdict(list)
    for trial in data.trials:
        if "skin_shift_mm" in trial.values:
            amounts = trial.values["skin_shift_mm"], trial.values["skin_indentation_mm"]
            groups[(*amounts, trial.method)].append(trial)
    if not groups:
        return Markup()
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
    return render("shifted_skin", rows=rows)
