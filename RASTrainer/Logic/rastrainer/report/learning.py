"""How trainees changed from trial to trial, as curves, and whether that is significant."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np

from rastrainer.number_text import fixed, p_text, percent, significant
from rastrainer.report import page, svg
from rastrainer.report.paired_statistics import interval_text
from rastrainer.statistics.trend import (
    ALPHA,
    MIN_FIT_TRIALS,
    STEADY,
    CohortTrend,
    LearningCurve,
    TrendVerdict,
    cohort_trends,
    fit_learning_curve,
)
from rastrainer.study.outcomes import MAIN_OUTCOMES, Outcome, mode_title, short_mode_title
from rastrainer.study.study_data import StudyData, values_of

SHOWN = ("completion_time_s", "rmse_mm", "score")
MIN_CURVE_TRIALS = 8
"""With fewer trials the plateau is too uncertain to report."""
HEADER: page.Line = [
    *("Outcome", page.text("mode"), "n", "trials", "first", "last", "change [95 %]"),
    *("p (Page)", "p (Holm)", "alone: better / steady / undecided"),
]

WORDS = (
    "First and last: means of the trainees at their first trial and at the last that all of them "
    "did. Change: between these two by each trainee's regression line over ln(trial), the mean of "
    "all. Page's test (one-sided) asks whether all trainees together get better: that is shown "
    "where its p, corrected by Holm's method for all such tests of this table, is below "
    f"{percent(ALPHA)}. Each trainee alone: better by the permutation test of the slope "
    "(one-sided; one in twenty who do not learn passes it by chance), steady where a change by "
    f"{percent(STEADY)} of the mean is excluded, and undecided where the trials allow both; these "
    "tests are not corrected for being several."
)
Points = dict[str, list[tuple[float, float]]]


def learning(data: StudyData) -> str:
    """Return the curves of each mode over the trials, or over the tasks if the order is unknown."""
    points, trends = _all_points(data), learning_trends(data)
    charts, rows, sentences = [], [], []
    for (outcome, mode), own in points.items():
        trend = trends.get((outcome, mode))
        curve = _curve(trend, outcome)
        fitted = []
        if curve is not None:
            last = max(map(len, own.values()))
            fitted = [(x, curve.at(x)) for x in np.linspace(1, last, 60)]
        values = values_of(data.trials, outcome.name)
        charts.append(
            learning_curves(
                f"{short_mode_title(mode)}: {outcome.heading}",
                svg.mode_color(mode, data.modes.index(mode)),
                own,
                "trial" if data.has_order else "task",
                fitted,
                (min(values), max(values)),
            )
        )
        if data.has_order:
            rows.append(_row(outcome, mode, trend, len(own)))
        if curve is not None and trend is not None and len(trend.means) >= MIN_CURVE_TRIALS:
            sentences.append(
                f"{outcome.title}, {mode_title(mode)}: the means follow a·n^−b + c with "
                f"a = {fixed(curve.gain, outcome.digits)} {outcome.unit}, "
                f"b = {fixed(curve.rate, 2)} and "
                f"c = {fixed(curve.plateau, outcome.digits)} {outcome.unit} "
                f"(R² = {fixed(curve.r_squared, 2)})."
            )
    return page.section(
        "Learning curves",
        page.figure(
            charts,
            "Thin: each trainee. Thick: the means of all or, where getting better is shown, the "
            "curve that is fitted to them.",
        ),
        *([page.table([HEADER], rows, "wide"), page.paragraph(WORDS, "small")] if rows else []),
        page.bullets(sentences),
        page.paragraph(_limits(data)),
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
    shown = [outcome for outcome in MAIN_OUTCOMES if outcome.name in SHOWN]
    found = {
        (outcome, mode): _points(data, mode, outcome) for outcome in shown for mode in data.modes
    }
    return {key: points for key, points in found.items() if points}


def _points(data: StudyData, mode: str, outcome: Outcome) -> Points:
    points: Points = defaultdict(list)
    tasks = {task: number for number, task in enumerate(data.tasks, start=1)}
    for trial in data.of_mode(mode):
        if outcome.name in trial.values:
            number = trial.number if data.has_order else tasks[trial.task]
            points[trial.trainee].append((float(number), trial.values[outcome.name]))
    return {trainee: sorted(own) for trainee, own in points.items()}


def _curve(trend: CohortTrend | None, outcome: Outcome) -> LearningCurve | None:
    """Return the curve of the means if they fall significantly."""
    if trend is None or not trend.is_shown or outcome.better > 0:
        return None
    return fit_learning_curve(trend.means) if len(trend.means) >= MIN_FIT_TRIALS else None


def _row(outcome: Outcome, mode: str, trend: CohortTrend | None, trainees: int) -> page.Line:
    start: page.Line = [outcome.heading, page.text(mode_title(mode))]
    if trend is None:
        return [*start, str(trainees), "too few", *["–"] * (len(HEADER) - 4)]
    change = "–"
    if trend.change is not None and trend.interval is not None:
        change = interval_text(trend.change, trend.interval, outcome.digits)
    counts = [trend.verdicts[verdict] for verdict in TrendVerdict]
    return [
        *start,
        str(trend.trainees),
        str(len(trend.means)),
        outcome.text(trend.means[0]),
        outcome.text(trend.means[-1]),
        change,
        *("–" if p is None else p_text(p) for p in (trend.p, trend.adjusted_p)),
        " / ".join(map(str, counts)),
    ]


def _limits(data: StudyData) -> str:
    if not data.has_order:
        return (
            "The order of the trials is not in the data; the tasks stand in the order of their "
            "numbers. Where tasks were always done in this order, difficulty, practice and "
            "fatigue cannot be separated, and a rising curve does not disprove learning."
        )
    if len(data.tasks) == 1:
        return "All trials were of one task: curves and tests show practice and fatigue together."
    is_fixed = data.protocol is None or data.protocol.task_order == "fixed"
    if is_fixed:
        return (
            "Tasks of different difficulty were done one after the other: curves and tests show "
            "practice and difficulty together, and harder tasks later on hide what is learned."
        )
    return "Tasks were balanced over the trainees: the means show practice and fatigue."


WIDTH, HEIGHT = 330, 232
LEFT, RIGHT, TOP, BOTTOM = 46, 318, 32, 190


def learning_curves(
    heading: str,
    color: str,
    trainees: Mapping[str, Sequence[tuple[float, float]]],
    x_title: str,
    curve: Sequence[tuple[float, float]] = (),
    span: Sequence[float] = (),
) -> str:
    """Return the chart of every trainee's values over the trials, with the curve of all.

    Args:
        trainees: Pseudonym → points (trial number, value).
        curve: A fitted curve; by default the means are connected.
        span: Further values that the axis must include, to make charts comparable.
    """
    sheet = svg.Sheet(WIDTH, HEIGHT, heading)
    points = [point for own in trainees.values() for point in own]
    numbers = sorted({x for x, _ in points})
    axis = svg.axis_over([*span, *(y for _, y in points)], BOTTOM, TOP)
    svg.y_grid(sheet, axis, LEFT, RIGHT)
    across = svg.Axis(numbers[0] - 0.35, numbers[-1] + 0.35, LEFT, RIGHT)
    opacity = 0.55 if len(trainees) <= 12 else max(0.08, 6 / len(trainees))
    for name, own in trainees.items():
        sheet.polyline([(across.at(x), axis.at(y)) for x, y in own], color, 1.2, opacity)
        if len(trainees) <= 24:
            for x, y in own:
                sheet.dot(across.at(x), axis.at(y), 2.6, color, 0.8, f"{name}: {significant(y, 4)}")
    means = [(x, float(np.mean([y for n, y in points if n == x]))) for x in numbers]
    sheet.polyline([(across.at(x), axis.at(y)) for x, y in curve or means], svg.INK, 2.4)
    ticks = numbers if len(numbers) <= 12 else across.ticks(6)
    for tick in ticks:
        sheet.text(across.at(tick), BOTTOM + 16, f"{tick:g}", 10, svg.FAINT, "middle")
    sheet.text((LEFT + RIGHT) / 2, HEIGHT - 8, x_title, 10, svg.FAINT, "middle")
    return sheet.svg()
