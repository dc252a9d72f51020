"""Trainees: their answers, groups by performance, and their progress in curricula."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
from markupsafe import Markup

from rastrainer.study.curriculum.standing import by_curriculum, goal_of, short_progress_of, title_of
from rastrainer.study.outcomes import CLUSTER_METRICS, MAIN_OUTCOMES, MOTION_OUTCOMES, mode_title
from rastrainer.study.protocol.questionnaires import QUESTIONNAIRES
from rastrainer.study.study_data import StudyData
from rastrainer_simulator.report.mode_comparison import mean_and_sd
from rastrainer_simulator.report.page import render
from rastrainer_simulator.statistics.trainee_clusters import NoClustersError, cluster_trainees

MAX_NAMED = 12


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
