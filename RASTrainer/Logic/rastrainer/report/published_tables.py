"""The paper's score (CTPS) and Tables I and II from the trials; its numbers and claims checked."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from rastrainer.errors import InputError
from rastrainer.number_text import counted, fixed, p_phrase, significant
from rastrainer.report import page
from rastrainer.statistics.intervals import Correlation, correlation
from rastrainer.study.outcomes import mode_title, task_title
from rastrainer.study.study_data import StudyData
from rastrainer.trial.ctps import (
    CTPS_WARNING,
    CohortScores,
    Printed,
    published_ctps,
    score_cohort,
    task_number,
)

MAX_COLUMNS = 6
ROMAN = ("I", "II", "III", "IV")
RED, YELLOW, GREEN = (244, 165, 158), (252, 234, 170), (171, 219, 165)


def with_ctps(data: StudyData) -> StudyData:
    """Return the study with `ctps` in the values of each registered trial."""
    references = {mode: cohort_scores(data, mode) for mode in data.modes}
    trials = []
    for trial in data.trials:
        scores, values = references[trial.mode], trial.values
        if scores is not None and "rmse_mm" in values:
            measures = values["completion_time_s"], values["rmse_mm"]
            ctps = published_ctps(*measures, scores.reference)
            trial = replace(trial, values={**values, "ctps": ctps})
        trials.append(trial)
    return replace(data, trials=tuple(trials))


def cohort_scores(data: StudyData, mode: str) -> CohortScores | None:
    """Return the CTPS table of a mode, or None without a reference."""
    try:
        return score_cohort(data.ctps_trials(mode), data.mean_ct_s.get(mode))
    except InputError:
        return None


def complexity_correlation(values: Iterable[tuple[str, float]]) -> Correlation | None:
    """Return the correlation of values (task, value) with the tasks' numbers, or None."""
    pairs = [(task_number(task), value) for task, value in values]
    numbered = np.array([pair for pair in pairs if pair[0] is not None], dtype=float)
    try:
        return correlation(*numbered.T) if len(numbered) else None
    except InputError:
        return None


def published_tables(data: StudyData) -> str:
    """Return both tables, colored from red (hard, low) to green (easy, high)."""
    parts = []
    for number, mode in enumerate(data.modes):
        scores = cohort_scores(data, mode)
        if scores is None:
            continue
        counts = f"{counted(len(scores.subjects), 'trainee')}, "
        counts += counted(len(scores.trials), "trial")
        parts.append(page.heading(f"Table {ROMAN[number % 4]}. {mode_title(mode)}: {counts}"))
        few = len(scores.subjects) <= MAX_COLUMNS
        parts.append(_whole(data, mode, scores) if few else _by_task(data, mode, scores))
        parts.append(page.note(_overall(mode, scores) + _complexity(data, mode, scores)))
    if not parts:
        return ""
    warning = page.warning(f"How to read CTPS: {CTPS_WARNING}")
    return page.section("Performance as the paper tabulates it", *parts, warning)


def performance_color(value: float, values: Iterable[float]) -> str:
    """Return the color of a score among others, from red to green."""
    values = list(values)
    low, high = min(values), max(values)
    share = 0.5 if low == high else (value - low) / (high - low)
    pair = (RED, YELLOW) if share < 0.5 else (YELLOW, GREEN)
    weight = 2 * share - (share >= 0.5)
    mixed = (round(a + weight * (b - a)) for a, b in zip(*pair, strict=True))
    return "#" + "".join(f"{part:02x}" for part in mixed)


def _whole(data: StudyData, mode: str, scores: CohortScores) -> str:
    subjects = list(scores.subjects)
    titles = [f"Subject {name}" if name.isdigit() else name for name in subjects]
    headers: list[page.Line] = [
        [
            page.Cell("", kind="group"),
            *(page.Cell(title, 2, kind="group") for title in titles),
            page.Cell("", kind="group"),
        ],
        ["Task", *("CT (s)", "RMSE (mm)") * len(subjects), "Task Perf."],
    ]
    trials = {(t.task, t.trainee): t.values for t in data.of_mode(mode) if "rmse_mm" in t.values}
    rows: list[page.Line] = []
    for task in (task for task in data.tasks if task in scores.tasks):
        line: page.Line = [task_title(task)]
        for subject in subjects:
            values = trials.get((task, subject))
            line += (
                ["–", "–"]
                if values is None
                else [f"{values['completion_time_s']:.2f}", f"{values['rmse_mm']:.2f}"]
            )
        rows.append([*line, _performance(scores.tasks[task], scores.tasks.values())])
    last: page.Line = [page.Cell("User Perf.", kind="total")]
    for subject in subjects:
        color = performance_color(scores.subjects[subject], scores.subjects.values())
        last.append(page.Cell(fixed(scores.subjects[subject], 2), 2, color, "total"))
    return page.table(
        headers, [*rows, [*last, page.Cell(fixed(scores.overall, 2), kind="total")]], "wide tasks"
    )


def _by_task(data: StudyData, mode: str, scores: CohortScores) -> str:
    """Return the table of a cohort too large for a column per subject."""
    rows: list[page.Line] = []
    for task in (task for task in data.tasks if task in scores.tasks):
        own = [t.values for t in data.of_mode(mode) if t.task == task and "rmse_mm" in t.values]
        cells = [str(len(own))]
        for name, digits in (("completion_time_s", 1), ("rmse_mm", 2)):
            values = [v[name] for v in own]
            spread = f" ± {np.std(values, ddof=1):.{digits}f}" if len(values) > 1 else ""
            cells.append(f"{np.mean(values):.{digits}f}{spread}")
        rows.append(
            [task_title(task), *cells, _performance(scores.tasks[task], scores.tasks.values())]
        )
    low, middle, high = np.quantile(list(scores.subjects.values()), [0, 0.5, 1])
    span = f"{fixed(low, 1)} to {fixed(high, 1)}, median {fixed(middle, 1)}"
    users = f"{len(scores.subjects)} users: {span}"
    total = [page.Cell("User Perf.", kind="total"), page.Cell(users, 3, kind="total")]
    rows.append([*total, page.Cell(fixed(scores.overall, 2), kind="total")])
    return page.table([["Task", "trials", "CT (s)", "RMSE (mm)", "Task Perf."]], rows)


def _performance(value: float, among: Iterable[float]) -> page.Cell:
    return page.Cell(fixed(value, 2), color=performance_color(value, among), kind="marginal")


def _overall(mode: str, scores: CohortScores) -> str:
    spread = (
        ""
        if scores.sd_sample is None
        else f" ± {scores.sd_sample:.2f} "
        f"(SD, divided by n − 1; {scores.sd_population:.2f} divided by n)"
    )
    correlated = (
        ""
        if scores.pearson_r is None
        else " Task number and mean time of the task correlate "
        f"with r = {fixed(scores.pearson_r, 3)}, r² = {scores.r_squared:.3f}."
    )
    return (
        f"Overall CTPS of {mode_title(mode)}: {fixed(scores.overall, 2)}{spread} over "
        f"{len(scores.trials)} trials; {fixed(scores.equation_3_overall, 2)} by the paper's "
        "equation 3. "
        f"Measured against a mean time of {scores.reference.mean_ct_s:.2f} s and a best RMSE of "
        f"{scores.reference.best_rmse_mm:.2f} mm.{correlated}"
    )


def _complexity(data: StudyData, mode: str, scores: CohortScores) -> str:
    """Return how time and CTPS correlate with the tasks' numbers."""
    trials = data.ctps_trials(mode)
    of_times = complexity_correlation((t.task, t.completion_time_s) for t in trials)
    of_trials = complexity_correlation(
        (trial.task, score) for trial, score in zip(trials, scores.trials, strict=True)
    )
    task_times = complexity_correlation(
        (task, float(np.mean([t.completion_time_s for t in trials if t.task == task])))
        for task in scores.tasks
    )
    task_scores = complexity_correlation(scores.tasks.items())
    if not (of_times and of_trials and task_times and task_scores):
        return ""
    return (
        f" With the number of the task as its complexity, over {task_times.n} task means: time "
        f"{_correlation(task_times)}, CTPS {_correlation(task_scores)}; over the {of_times.n} "
        f"trials: time r = {fixed(of_times.r, 2)}, CTPS r = {fixed(of_trials.r, 2)} "
        "(not tested: trials of a trainee depend on each other)."
    )


def _correlation(found: Correlation) -> str:
    interval = ""
    if found.interval is not None:
        interval = f" [{fixed(found.interval[0], 3)}, {fixed(found.interval[1], 3)}]"
    return f"r = {fixed(found.r, 2)}{interval}, {p_phrase(found.p)}"


def paper_notes(data: StudyData) -> str:
    """Return the section; "" for a study without notes."""
    notes = data.notes
    if notes is None:
        return ""
    rows = []
    for printed in notes.printed:
        trials = data.ctps_trials(printed.mode)
        count = counted(len(trials), "trial")
        if printed.quantity in ("pearson_r", "r_squared"):
            count = counted(len({trial.task for trial in trials}), "task mean")
        rows.append([printed.what, count, printed.printed, _ours(data, printed)])
    claims = [[page.text(each.claim), page.text(each.numbers)] for each in notes.claims]
    return page.section(
        "The paper's numbers, checked",
        page.paragraph(f"Source: {notes.source}."),
        page.table([["what", "n", "printed", "from the trials"]], rows),
        page.heading("What does not fit"),
        page.bullets([each.sentence for each in notes.inconsistencies]),
        page.heading("The claims"),
        page.table(
            [[page.text("The paper says"), page.text("The trials say")]],
            claims,
        ),
    )


def _ours(data: StudyData, printed: Printed) -> str:
    trials = data.ctps_trials(printed.mode)
    scores = cohort_scores(data, printed.mode)
    if scores is None:
        return "–"
    if printed.quantity == "mean_ct":
        value = float(np.mean([trial.completion_time_s for trial in trials]))
    elif printed.quantity == "mean_rmse":
        value = float(np.mean([trial.rmse_mm for trial in trials]))
    else:
        value = getattr(scores, printed.quantity)
    if value is None:
        return "–"
    return significant(value, 4) if abs(value) < 1 else fixed(value, 3)
