"""The paper's score (CTPS) and Tables I and II from the trials; its numbers and claims checked."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from markupsafe import Markup

from rastrainer.errors import InputError
from rastrainer.number_text import counted, fixed, significant
from rastrainer.study.study_data import StudyData
from rastrainer.trial import ctps
from rastrainer_simulator.report.mode_comparison import mean_and_sd
from rastrainer_simulator.report.page import render
from rastrainer_simulator.statistics.intervals import Correlation, correlation

MAX_COLUMNS = 6
RED, YELLOW, GREEN = (244, 165, 158), (252, 234, 170), (171, 219, 165)


def with_ctps(data: StudyData) -> StudyData:
    references = {mode: cohort_scores(data, mode) for mode in data.modes}
    trials = []
    for trial in data.trials:
        scores, values = references[trial.mode], trial.values
        if scores is not None and ctps.RMSE in values:
            score = ctps.published_ctps(values[ctps.TIME], values[ctps.RMSE], scores.reference)
            trial = replace(trial, values={**values, "ctps": score})
        trials.append(trial)
    return replace(data, trials=tuple(trials))


def cohort_scores(data: StudyData, mode: str) -> ctps.CohortScores | None:
    """Return the CTPS table of a mode, or None without a reference."""
    try:
        return ctps.score_cohort(data.ctps_trials(mode), data.mean_ct_s.get(mode))
    except InputError:
        return None


def published_tables(data: StudyData) -> Markup:
    """Return both tables, colored from red (hard, low) to green (easy, high)."""
    tables = []
    for number, mode in enumerate(data.modes):
        scores = cohort_scores(data, mode)
        if scores is None:
            continue
        trials = data.ctps_trials(mode)
        tables.append(
            {
                "number": number,
                "mode": mode,
                "scores": scores,
                "tasks": [task for task in data.tasks if task in scores.tasks],
                "trials": {(trial.task, trial.trainee): trial.values for trial in trials},
                "of_task": {
                    task: [trial.values for trial in trials if trial.task == task]
                    for task in scores.tasks
                },
                "span": np.quantile([*scores.subjects.values()], [0, 0.5, 1]).tolist(),
                "complexity": complexity(data, mode, scores),
            }
        )
    if not tables:
        return Markup()
    return render(
        "published_tables",
        tables=tables,
        most_columns=MAX_COLUMNS,
        color=performance_color,
        mean_and_sd=mean_and_sd,
        warning=ctps.CTPS_WARNING,
    )


def performance_color(value: float, values: Iterable[float]) -> str:
    values = list(values)
    low, high = min(values), max(values)
    share = 0.5 if low == high else (value - low) / (high - low)
    pair = (RED, YELLOW) if share < 0.5 else (YELLOW, GREEN)
    weight = 2 * share - (share >= 0.5)
    mixed = (round(a + weight * (b - a)) for a, b in zip(*pair, strict=True))
    return "#" + "".join(f"{part:02x}" for part in mixed)


def complexity(
    data: StudyData, mode: str, scores: ctps.CohortScores
) -> dict[str, Correlation] | None:
    trials = data.ctps_trials(mode)
    times = {task: [t.values[ctps.TIME] for t in trials if t.task == task] for task in scores.tasks}
    values = {
        "times": [(trial.task, trial.values[ctps.TIME]) for trial in trials],
        "scores": [(t.task, score) for t, score in zip(trials, scores.trials, strict=True)],
        "task_times": [(task, float(np.mean(own))) for task, own in times.items()],
        "task_scores": list(scores.tasks.items()),
    }
    found = {}
    for name, pairs in values.items():
        numbered = [(ctps.task_number(task), value) for task, value in pairs]
        known = np.array([pair for pair in numbered if pair[0] is not None], dtype=float)
        try:
            found[name] = correlation(*known.reshape(-1, 2).T)
        except InputError:
            return None
    return found


def paper_notes(data: StudyData) -> Markup:
    """Return the section; "" for a study without notes."""
    if data.notes is None:
        return Markup()
    rows = []
    for printed in data.notes.printed:
        trials = data.ctps_trials(printed.mode)
        count = counted(len(trials), "trial")
        if printed.quantity in ("pearson_r", "r_squared"):
            count = counted(len({trial.task for trial in trials}), "task mean")
        rows.append([printed.what, count, printed.printed, _ours(data, printed)])
    return render("paper_notes", notes=data.notes, rows=rows)


def _ours(data: StudyData, printed: ctps.Printed) -> str:
    trials = data.ctps_trials(printed.mode)
    scores = cohort_scores(data, printed.mode)
    if scores is None:
        return "–"
    if printed.quantity == "mean_ct":
        value = float(np.mean([trial.values[ctps.TIME] for trial in trials]))
    elif printed.quantity == "mean_rmse":
        value = float(np.mean([trial.values[ctps.RMSE] for trial in trials]))
    else:
        value = getattr(scores, printed.quantity)
    if value is None:
        return "–"
    return significant(value, 4) if abs(value) < 1 else fixed(value, 3)
