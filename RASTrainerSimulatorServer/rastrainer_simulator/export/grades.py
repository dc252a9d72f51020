"""Grades of a course: one score for each trainee, as CSV that Moodle or Canvas imports."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rastrainer.study.tidy_csv import csv_text
from rastrainer.trial.trial_row import TrialRow

GRADE_COLUMN = "RASTrainer"
FULL_GRADE = 100
CANVAS_COLUMNS = ("Student", "ID", "SIS User ID", "SIS Login ID", "Section", GRADE_COLUMN)
"""As in Canvas's own export; a student is found by any of the first four."""


def grade(
    trials: Iterable[TrialRow],
    task: str | None,
    mode: str | None,
    method: str,
    rule: str,
) -> float | None:
    """Return the score of the trial that counts, 0 to 100; None without an acceptable one.

    A trial that is not acceptable gives no grade: its registration would have misled an
    instrument. The trials are a trainee's attempts, in order of starting. A trial counts if it has
    the `task`, the `mode` (None for any) and the `method`, since methods are not compared. Drills
    have none, "", and those that are not passed are not acceptable.
    """
    scores = [
        trial.score
        for trial in trials
        if trial.acceptable
        and trial.method == method
        and task in (None, trial.task)
        and mode in (None, trial.mode)
    ]
    if not scores:
        return None
    return max(scores) if rule == "best" else scores[-1]


def grades_csv(grades: Mapping[str, float], platform: str) -> str:
    rows = [(name, f"{score:.2f}") for name, score in sorted(grades.items())]
    if platform == "moodle":
        return csv_text(("ID number", GRADE_COLUMN), rows)
    points = ("Points Possible", "", "", "", "", FULL_GRADE)
    students = [(name, "", "", name, "", score) for name, score in rows]
    return csv_text(CANVAS_COLUMNS, [points, *students])
