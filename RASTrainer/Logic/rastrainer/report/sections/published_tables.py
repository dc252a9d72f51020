"""The paper's Tables I and II: times and errors, with the performance of tasks and users."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from rastrainer.ctps import CTPS_WARNING, CohortScores
from rastrainer.report.markup import Cell, heading, paragraph, section, table
from rastrainer.report.outcomes import mode_title, task_title
from rastrainer.report.published_scores import cohort_scores
from rastrainer.report.study_data import StudyData

MOST_COLUMNS = 6
ROMAN = ("I", "II", "III", "IV")
RED, YELLOW, GREEN = (244, 165, 158), (252, 234, 170), (171, 219, 165)


def published_tables(data: StudyData) -> str:
    """Return both tables, colored from red (hard, low) to green (easy, high)."""
    parts = []
    for number, mode in enumerate(data.modes):
        scores = cohort_scores(data, mode)
        if scores is None:
            continue
        parts.append(heading(f"Table {ROMAN[number % 4]}. {mode_title(mode)}"))
        few = len(scores.subjects) <= MOST_COLUMNS
        parts.append(_whole(data, mode, scores) if few else _by_task(data, mode, scores))
        parts.append(paragraph(_overall(mode, scores), "small"))
    if not parts:
        return ""
    warning = paragraph(f"How to read CTPS: {CTPS_WARNING}", "warning")
    return section("Performance as the paper tabulates it", *parts, warning)


def performance_color(value: float, values: Iterable[float]) -> str:
    """Return the color of a score among others: red, yellow, green."""
    values = list(values)
    low, high = min(values), max(values)
    share = 0.5 if low == high else (value - low) / (high - low)
    pair = (RED, YELLOW) if share < 0.5 else (YELLOW, GREEN)
    weight = 2 * share - (share >= 0.5)
    mixed = (round(a + weight * (b - a)) for a, b in zip(*pair, strict=True))
    return "#" + "".join(f"{part:02x}" for part in mixed)


def _whole(data: StudyData, mode: str, scores: CohortScores) -> str:
    subjects = list(scores.subjects)
    headers = [
        [
            "",
            *(Cell(_subject(name), 2, kind="group") for name in subjects),
            Cell("", kind="group"),
        ],
        ["Task", *("CT (s)", "RMSE (mm)") * len(subjects), "Task Perf."],
    ]
    trials = {(t.task, t.trainee): t.values for t in data.of_mode(mode) if "rmse_mm" in t.values}
    rows = []
    for task in (task for task in data.tasks if task in scores.tasks):
        line: list[Cell | str] = [task_title(task)]
        for subject in subjects:
            values = trials.get((task, subject))
            line += (
                ["–", "–"]
                if values is None
                else [
                    f"{values['completion_time_s']:.2f}",
                    f"{values['rmse_mm']:.2f}",
                ]
            )
        rows.append([*line, _performance(scores.tasks[task], scores.tasks.values())])
    last: list[Cell | str] = [Cell("User Perf.", kind="total")]
    for subject in subjects:
        color = performance_color(scores.subjects[subject], scores.subjects.values())
        last.append(Cell(f"{scores.subjects[subject]:.2f}", 2, color, "total"))
    return table(
        headers, [*rows, [*last, Cell(f"{scores.overall:.2f}", kind="total")]], "wide tasks"
    )


def _by_task(data: StudyData, mode: str, scores: CohortScores) -> str:
    """Return the table of a cohort that is too large for a column a subject."""
    rows = []
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
    users = f"{len(scores.subjects)} users: {low:.1f} to {high:.1f}, median {middle:.1f}"
    total = [Cell("User Perf.", kind="total"), Cell(users, 3, kind="total")]
    rows.append([*total, Cell(f"{scores.overall:.2f}", kind="total")])
    return table([["Task", "trials", "CT (s)", "RMSE (mm)", "Task Perf."]], rows)


def _performance(value: float, among: Iterable[float]) -> Cell:
    return Cell(f"{value:.2f}", color=performance_color(value, among), kind="marginal")


def _subject(name: str) -> str:
    return f"Subject {name}" if name.isdigit() else name


def _overall(mode: str, scores: CohortScores) -> str:
    spread = (
        ""
        if scores.sd_sample is None
        else f" ± {scores.sd_sample:.2f} "
        f"(divided by n − 1; {scores.sd_population:.2f} divided by n)"
    )
    correlation = (
        ""
        if scores.pearson_r is None
        else " Task number and mean time of the task correlate "
        f"with r = {scores.pearson_r:.3f}, r² = {scores.r_squared:.3f}."
    )
    return (
        f"Overall CTPS of {mode_title(mode)}: {scores.overall:.2f}{spread} over "
        f"{len(scores.trials)} trials; {scores.equation_3_overall:.2f} by the paper's equation 3. "
        f"Measured against a mean time of {scores.reference.mean_ct_s:.2f} s and a best RMSE of "
        f"{scores.reference.best_rmse_mm:.2f} mm.{correlation}"
    )
