"""The modes side by side: by task (the paper's Fig. 8), as distributions, and by trainee."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

from rastrainer.number_text import fixed
from rastrainer.study.outcomes import (
    MAIN_OUTCOMES,
    MOTION_OUTCOMES,
    mode_title,
    short_mode_title,
    task_title,
)
from rastrainer.study.study_data import StudyData, values_of
from rastrainer_simulator.report import charts
from rastrainer_simulator.report.comparisons import ModeComparison
from rastrainer_simulator.report.page import render
from rastrainer_simulator.statistics.paired import equivalence_margin

SHOWN = ("completion_time_s", "rmse_mm", "ctps", "score")
MAX_PAIRED_CHARTS = 6


def mode_comparison(data: StudyData) -> Markup:
    """Return one chart per outcome by task, and one with a lane for each mode."""
    modes = [(mode, charts.mode_color(mode, index)) for index, mode in enumerate(data.modes)]
    by_task, distributions = [], []
    for outcome in MAIN_OUTCOMES:
        lanes = [
            (short_mode_title(mode), color, values)
            for mode, color in modes
            if (values := values_of(data.of_mode(mode), outcome.name))
        ]
        if not lanes:
            continue
        distributions.append(charts.distribution(outcome.heading, lanes))
        if outcome.name not in SHOWN:
            continue
        series = []
        for mode, color in modes:
            trials = [[t for t in data.of_mode(mode) if t.task == task] for task in data.tasks]
            by_trial = [values_of(own, outcome.name) for own in trials]
            series.append((mode_title(mode), color, by_trial))
        titles = [task_title(task) for task in data.tasks]
        by_task.append(charts.grouped_bars(outcome.heading, titles, series))
    return render("mode_comparison", by_task=by_task, distributions=distributions)


def motion(data: StudyData, comparisons: Sequence[ModeComparison]) -> Markup:
    """Return the table; "" if no trial was recorded."""
    found = {name for trial in data.trials for name in trial.values}
    outcomes = [outcome for outcome in MOTION_OUTCOMES if outcome.name in found]
    if not outcomes:
        return Markup()
    compared = {one.outcome.name: one.result for one in comparisons}
    rows = []
    for outcome in outcomes:
        values = [values_of(data.of_mode(mode), outcome.name) for mode in data.modes]
        means = [mean_and_sd(own, outcome.digits) for own in values]
        rows.append((outcome, means, [len(own) for own in values], compared.get(outcome.name)))
    return render("motion", modes=data.modes, rows=rows)


def paired_statistics(comparisons: Sequence[ModeComparison]) -> Markup:
    """Return tables, charts and sentences; "" if no trainee did two modes."""
    if not comparisons:
        return Markup()
    results = [(one.outcome, one.result) for one in comparisons if one.result is not None]
    return render(
        "paired_statistics",
        first=comparisons[0].first,
        second=comparisons[0].second,
        comparisons=comparisons,
        margin=equivalence_margin,
        separated=[(outcome, found.sequences) for outcome, found in results if found.sequences],
        is_order_known=any(comparison.order is not None for comparison in comparisons),
        charts=[charts.paired_lines(one) for one in comparisons[:MAX_PAIRED_CHARTS]],
        effects=charts.effect_sizes(comparisons) if any(r.effect for _, r in results) else None,
    )


def mean_and_sd(values: Sequence[float], digits: int) -> str:
    """Return `12.3 ± 0.4`: the sample's standard deviation, of two values or more."""
    if not values:
        return "–"
    text = fixed(float(np.mean(values)), digits)
    if len(values) > 1:
        text += f" ± {fixed(float(np.std(values, ddof=1)), digits)}"
    return text
