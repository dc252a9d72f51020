"""Trainees: learning from trial to trial, answers, groups by performance, and curricula."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
from markupsafe import Markup

from rastrainer.study.curriculum.standing import by_curriculum, goal_of, short_progress_of, title_of
from rastrainer.study.outcomes import (
    CLUSTER_METRICS,
    MAIN_OUTCOMES,
    MOTION_OUTCOMES,
    Outcome,
    mode_title,
    short_mode_title,
)
from rastrainer.study.protocol.questionnaires import QUESTIONNAIRES
from rastrainer.study.study_data import StudyData, values_of
from rastrainer_simulator.report import charts
from rastrainer_simulator.report.mode_comparison import mean_and_sd
from rastrainer_simulator.report.page import render
from rastrainer_simulator.statistics.intervals import ALPHA
from rastrainer_simulator.statistics.trainee_clusters import NoClustersError, cluster_trainees
from rastrainer_simulator.statistics.trend import (
    MIN_FIT_TRIALS,
    STEADY,
    CohortTrend,
    TrendVerdict,
    cohort_trends,
    fit_learning_curve,
)

MAX_NAMED = 12
SHOWN = ("completion_time_s", "rmse_mm", "score")
MIN_CURVE_TRIALS = 8
"""The plateau of fewer trials is too uncertain to report."""
Points = dict[str, list[tuple[float, float]]]


def learning(data: StudyData) -> Markup:
    """Return the curves of each mode over the trials, or over the tasks if the order is unknown."""
    trends = learning_trends(data)
    pictures, rows, fits = [], [], []
    for (outcome, mode), own in _all_points(data).items():
        trend = trends.get((outcome, mode))
        curve, fitted = None, []
        # Only of means that fall significantly.
        if trend is not None and trend.is_shown and outcome.better <= 0:
            has_enough = len(trend.means) >= MIN_FIT_TRIALS
            curve = fit_learning_curve(trend.means) if has_enough else None
        if curve is not None:
            last = max(map(len, own.values()))
            fitted = [(x, curve.at(x)) for x in np.linspace(1, last, 60)]
        values = values_of(data.trials, outcome.name)
        pictures.append(
            charts.learning_curves(
                f"{short_mode_title(mode)}: {outcome.heading}",
                charts.mode_color(mode, data.modes.index(mode)),
                own,
                "trial" if data.has_order else "task",
                fitted,
                (min(values), max(values)),
            )
        )
        rows.append((outcome, mode, trend, len(own)))
        if curve is not None and trend is not None and len(trend.means) >= MIN_CURVE_TRIALS:
            fits.append((outcome, mode, curve))
    return render(
        "learning",
        data=data,
        charts=pictures,
        rows=rows if data.has_order else [],
        fits=fits,
        verdicts=list(TrendVerdict),
        alpha=ALPHA,
        steady=STEADY,
    )


def learning_trends(data: StudyData) -> dict[tuple[Outcome, str], CohortTrend | None]:
    """Return how trainees changed, by outcome and mode; nothing if the order is unknown."""
    if not data.has_order:
        return {}
    points = _all_points(data)
    tested = [
        ([[value for _, value in own] for own in of_mode.values()], outcome.better)
        for (outcome, _mode), of_mode in points.items()
    ]
    return dict(zip(points, cohort_trends(tested), strict=True))


def _all_points(data: StudyData) -> dict[tuple[Outcome, str], Points]:
    tasks = {task: number for number, task in enumerate(data.tasks, start=1)}
    found = {}
    for outcome in (outcome for outcome in MAIN_OUTCOMES if outcome.name in SHOWN):
        for mode in data.modes:
            points: Points = defaultdict(list)
            for trial in data.of_mode(mode):
                if outcome.name in trial.values:
                    number = trial.number if data.has_order else tasks[trial.task]
                    points[trial.trainee].append((float(number), trial.values[outcome.name]))
            if points:
                found[outcome, mode] = {name: sorted(own) for name, own in points.items()}
    return found


def questionnaires(data: StudyData) -> Markup:
    """Return a table of scores by mode and occasion; "" if there are no answers."""
    if not data.answers:
        return Markup()
    values: dict[tuple[str, str, str], list[float]] = defaultdict(list)
    for answered in data.answers:
        step = answered.step
        if step.mode:
            when = "before" if "/before/" in step.name else "after"
            occasion = f"{when} {mode_title(step.mode)}"
        else:
            occasion = "before all" if step.name.startswith("before-all") else "after all"
        for scale, score in answered.scores.items():
            values[step.questionnaire, scale, occasion].append(score)
    rows = [
        (scale, when, len(scores), mean_and_sd(scores, 1), float(np.median(scores)))
        for name, questionnaire in QUESTIONNAIRES.items()
        for scale in questionnaire.scales
        for (asked, of_scale, when), scores in values.items()
        if (asked, of_scale) == (name, scale.name)
    ]
    asked = {name for name, _scale, _when in values}
    sources = [each for name, each in QUESTIONNAIRES.items() if name in asked]
    return render("questionnaires", rows=rows, sources=sources)


def groups(data: StudyData) -> Markup:
    values: dict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for trial in data.trials:
        for name, value in trial.values.items():
            values[trial.trainee][name].append(value)
    means = {
        trainee: {name: float(np.mean(found)) for name, found in own.items()}
        for trainee, own in values.items()
    }
    metrics = [m for m in CLUSTER_METRICS if all(m in own for own in means.values())]
    try:
        clusters = cluster_trainees(means, metrics)
    except NoClustersError as error:
        return render("groups", found=None, reason=str(error))
    outcomes = {outcome.name: outcome for outcome in (*MAIN_OUTCOMES, *MOTION_OUTCOMES)}
    shown = [outcomes[metric] for metric in clusters.metrics]
    return render("groups", found=clusters, outcomes=shown, most_named=MAX_NAMED)


def curricula(data: StudyData) -> Markup:
    """Return the section; "" if nobody follows a curriculum."""
    if not data.standings:
        return Markup()
    return render(
        "curricula",
        groups=by_curriculum(data.standings),
        progress=short_progress_of,
        title=title_of,
        goal=goal_of,
    )
