"""How trainees went on from trial to trial."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from rastrainer.errors import InputError
from rastrainer.learning.learning_curve import FEWEST_TRIALS, LearningCurve, fit_learning_curve
from rastrainer.report.charts.learning_curves import learning_curves
from rastrainer.report.charts.svg import mode_color
from rastrainer.report.markup import bullets, figure, paragraph, section
from rastrainer.report.outcomes import MAIN_OUTCOMES, Outcome, mode_title
from rastrainer.report.study_data import StudyData

SHOWN = ("completion_time_s", "rmse_mm", "score")

Points = dict[str, list[tuple[float, float]]]


def learning(data: StudyData) -> str:
    """Return the curves of each mode over the trials, or over the tasks where no order is known."""
    charts, sentences = [], []
    for outcome in (o for o in MAIN_OUTCOMES if o.name in SHOWN):
        for index, mode in enumerate(data.modes):
            points = _points(data, mode, outcome)
            if not points:
                continue
            curve = _mean_curve(points) if data.has_order and outcome.better < 0 else None
            charts.append(_chart(data, outcome, mode, index, points, curve))
            if data.has_order and outcome.better < 0:
                sentences.append(_sentence(outcome, mode, points, curve))
    return section(
        "Learning curves",
        figure(charts, "Every trainee; thick: the curve fitted to the means, or the means."),
        bullets(sentences),
        paragraph(_limits(data)),
    )


def _points(data: StudyData, mode: str, outcome: Outcome) -> Points:
    points: Points = defaultdict(list)
    tasks = {task: number for number, task in enumerate(data.tasks, start=1)}
    for trial in data.of_mode(mode):
        if outcome.name in trial.values:
            number = trial.number if data.has_order else tasks[trial.task]
            points[trial.trainee].append((float(number), trial.values[outcome.name]))
    return {trainee: sorted(own) for trainee, own in points.items()}


def _mean_curve(points: Points) -> LearningCurve | None:
    means = _means(points)
    try:
        return fit_learning_curve(means) if len(means) >= FEWEST_TRIALS else None
    except InputError:
        return None


def _means(points: Points) -> list[float]:
    """Return the mean of each trial number, as far as all trainees have come."""
    common = min(len(own) for own in points.values())
    return [float(np.mean([own[i][1] for own in points.values()])) for i in range(common)]


def _chart(
    data: StudyData,
    outcome: Outcome,
    mode: str,
    index: int,
    points: Points,
    curve: LearningCurve | None,
) -> str:
    x_title = "trial" if data.has_order else "task"
    fitted = []
    if curve is not None and curve.has_learned:
        fitted = [(x, curve.at(x)) for x in np.linspace(1, len(_means(points)), 60)]
    heading = f"{mode_title(mode).split(' ')[0]}: {outcome.heading}"
    span = [t.values[outcome.name] for t in data.trials if outcome.name in t.values]
    color = mode_color(mode, index)
    return learning_curves(heading, color, points, x_title, fitted, (min(span), max(span)))


def _sentence(outcome: Outcome, mode: str, points: Points, curve: LearningCurve | None) -> str:
    name = f"{outcome.title}, {mode_title(mode)}"
    if curve is None:
        return f"{name}: fewer than {FEWEST_TRIALS} trials each, no curve is fitted."
    learned = 0
    for own in points.values():
        try:
            learned += fit_learning_curve([value for _, value in own]).has_learned
        except InputError:
            continue
    if not curve.has_learned:
        return f"{name}: the means show no learning that a curve would explain better than chance."
    return (
        f"{name}: from {curve.at(1):.3g} to a plateau of {curve.plateau:.3g} {outcome.unit} "
        f"(a·n^−b + c, a = {curve.gain:.3g}, b = {curve.rate:.2f}, R² = {curve.r_squared:.2f}); "
        f"learning is shown for {learned} of {len(points)} trainees alone."
    )


def _limits(data: StudyData) -> str:
    if not data.has_order:
        return (
            "The order of the trials is not in the data; the tasks stand in the order of their "
            "numbers. Where tasks were always done in this order, difficulty, practice and fatigue "
            "cannot be told apart, and a rising curve is no proof against learning."
        )
    is_fixed = data.protocol is None or data.protocol.task_order == "fixed"
    if is_fixed and len(data.tasks) > 1:
        return (
            "Tasks of different difficulty were done one after the other; the curves show practice "
            "and difficulty together."
        )
    return "Tasks were balanced over the trainees, so that the curve of the means shows practice."
