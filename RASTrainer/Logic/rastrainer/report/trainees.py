"""Trainees: their answers, groups by performance, and their progress in curricula."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping

import numpy as np

from rastrainer.number_text import fixed, p_phrase
from rastrainer.report import page
from rastrainer.statistics.trainee_clusters import (
    NoClustersError,
    TraineeClusters,
    cluster_trainees,
)
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.standing import (
    CurriculumStanding,
    by_curriculum,
    goal_of,
    short_progress_of,
    title_of,
)
from rastrainer.study.outcomes import CLUSTER_METRICS, MAIN_OUTCOMES, MOTION_OUTCOMES, mode_title
from rastrainer.study.protocol.questionnaires import QUESTIONNAIRES, Scale
from rastrainer.study.study_data import StudyData
from rastrainer.study_messages import AssignmentStanding

NAMES = "ABCDE"
MAX_NAMED = 12
_CURRICULA_NOTE = (
    "Trials in a row that pass are a goal for practice, not a proof of competence: a trainee who "
    "plays long enough reaches them by chance. Aborted trials with a touch count as not passed, "
    "and n counts them. The day (UTC) is that of the trial by which an assignment was reached, or "
    "that opened it."
)


def questionnaires(data: StudyData) -> str:
    """Return a table of scores by mode and occasion; "" if there are no answers."""
    if not data.answers:
        return ""
    values: dict[tuple[str, str, str], list[float]] = defaultdict(list)
    for answered in data.answers:
        step = answered.step
        if step.mode:
            when = "before" if "/before/" in step.name else "after"
            occasion = f"{when} {mode_title(step.mode)}"
        else:
            occasion = "before all" if step.name.startswith("before-all") else "after all"
        for scale, score in answered.scores.items():
            values[answered.step.questionnaire, scale, occasion].append(score)
    rows: list[page.Line] = []
    sources = []
    for name, questionnaire in QUESTIONNAIRES.items():
        for scale_of in questionnaire.scales:
            for key, scores in values.items():
                if key[:2] == (name, scale_of.name):
                    rows.append(_row(scale_of, key[2], scores))
        if any(key[0] == name for key in values):
            sources.append(f"{questionnaire.title}: {questionnaire.source}.")
    header: list[page.Line] = [
        ["Scale", page.text("when"), "n", "mean ± SD", "median", "range", "better"]
    ]
    return page.section(
        "Questionnaires", page.table(header, rows), page.paragraph(" ".join(sources))
    )


def _row(scale: Scale, when: str, scores: list[float]) -> page.Line:
    spread = f" ± {np.std(scores, ddof=1):.1f}" if len(scores) > 1 else ""
    return [
        scale.title,
        page.text(when),
        str(len(scores)),
        f"{np.mean(scores):.1f}{spread}",
        f"{np.median(scores):.1f}",
        f"{scale.lowest:g} to {scale.highest:g}",
        "more" if scale.better > 0 else "less",
    ]


def groups(data: StudyData) -> str:
    """Return the section."""
    means = trainee_means(data)
    metrics = [m for m in CLUSTER_METRICS if all(m in values for values in means.values())]
    try:
        found = cluster_trainees(means, metrics)
    except NoClustersError as error:
        return page.section("Groups of trainees", page.paragraph(f"None are reported. {error}"))
    return page.section("Groups of trainees", _table(found), page.note(_words(found)))


def trainee_means(data: StudyData) -> dict[str, dict[str, float]]:
    """Return trainee → value → mean over all trials of the trainee."""
    values: dict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for trial in data.trials:
        for name, value in trial.values.items():
            values[trial.trainee][name].append(value)
    return {
        trainee: {name: float(np.mean(found)) for name, found in own.items()}
        for trainee, own in values.items()
    }


def _table(found: TraineeClusters) -> str:
    outcomes = {outcome.name: outcome for outcome in (*MAIN_OUTCOMES, *MOTION_OUTCOMES)}
    shown = [outcomes[metric] for metric in found.metrics]
    rows = []
    for index, members in enumerate(found.members):
        center = [o.text(v) for o, v in zip(shown, found.centers[index], strict=True)]
        names = ", ".join(members[:MAX_NAMED]) + (", …" if len(members) > MAX_NAMED else "")
        stability = f"{found.stability[index]:.2f}"
        rows.append([NAMES[index], str(len(members)), *center, stability, names])
    header = ["Group", "n", *(o.heading for o in shown), "stability", "trainees"]
    return page.table([header], rows)


def _words(found: TraineeClusters) -> str:
    return (
        f"k-means on z-scores; mean silhouette {fixed(found.silhouette, 2)}. That there is more "
        f"than one group is shown by the dip test ({p_phrase(found.dip_p)}), which finds groups in "
        "at most 5 % of studies of a population with a single peak, however skewed. Stability is "
        "the mean Jaccard similarity under resampling of trainees (Hennig 2007). A group describes "
        "these trainees; it does not say why they differ."
    )


def curricula(data: StudyData) -> str:
    """Return the section; "" if nobody follows a curriculum."""
    if not data.standings:
        return ""
    groups = by_curriculum(data.standings)
    parts = [_of_curriculum(each, found) for each, found in groups.items()]
    return page.section("Curriculum", *parts, page.note(_CURRICULA_NOTE))


def _of_curriculum(curriculum: Curriculum, found: Mapping[str, CurriculumStanding]) -> str:
    first = next(iter(found.values()))
    header = ["trainee", "trials (n)", "reached", *(each.name for each in curriculum.assignments)]
    rows = [
        [
            name,
            str(standing.played),
            f"{standing.reached} of {len(standing.standings)}",
            *map(short_progress_of, standing.standings),
        ]
        for name, standing in found.items()
    ]
    goals = [f"{each.name}: {_goal(each)}" for each in first.standings]
    return page.heading(curriculum.title) + page.table([header], rows) + page.bullets(goals)


def _goal(standing: AssignmentStanding) -> str:
    after = ", ".join(standing.after)
    gate = f"; after {after}" if after else ""
    return f"{title_of(standing)}, {goal_of(standing)}{gate}"
