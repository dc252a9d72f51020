"""The outcomes in a report: title, unit, and which direction is better."""

from __future__ import annotations

from dataclasses import dataclass

from rastrainer.motion.definitions import DEFINITIONS
from rastrainer.number_text import fixed

MODE_TITLES = {"desktop": "Desktop", "hmd": "Headset (HMD)"}
MODE_NAMES = {"desktop": "the desktop screen", "hmd": "the headset"}


@dataclass(frozen=True)
class Outcome:
    """An outcome of a trial.

    Attributes:
        name: Key in a trial's values.
        title: For people.
        unit: "" if none.
        better: -1 if less is better, 1 if more is, 0 if neither.
        digits: Decimals.
    """

    name: str
    title: str
    unit: str
    better: int
    digits: int

    @property
    def heading(self) -> str:
        """Title with unit."""
        return f"{self.title}, {self.unit}" if self.unit else self.title

    def text(self, value: float) -> str:
        """Return a value with its decimals, without its unit."""
        return fixed(value, self.digits)


MAIN_OUTCOMES = (
    Outcome("completion_time_s", "Completion time", "s", -1, 1),
    Outcome("rmse_mm", "Registration error (RMSE)", "mm", -1, 2),
    Outcome("ctps", "CTPS as published", "", 0, 1),
    Outcome("expected_tre_mm", "Expected target error", "mm", -1, 2),
    Outcome("true_tre_mm", "True target error", "mm", -1, 2),
    Outcome("score_tre_mm", "True error in the brain", "mm", -1, 2),
    Outcome("score_common_bias_mm", "Bias that all touches share", "mm", -1, 2),
    Outcome("score", "RASTrainer score", "", 1, 1),
)
MOTION_OUTCOMES = tuple(
    Outcome(d.name, d.title, d.unit, d.better, 0 if d.name.startswith("path_") and d.unit else 2)
    for d in DEFINITIONS.values()
    if d.name != "completion_time_s"
)
CLUSTER_METRICS = (
    "completion_time_s",
    "rmse_mm",
    "path_between_touches_mm",
    "sparc",
    "idle_time_s",
)
"""Metrics for grouping trainees, if all have them; few, because of few trainees."""


def mode_title(mode: str) -> str:
    """Return the title of a mode."""
    return MODE_TITLES.get(mode, mode)


def short_mode_title(mode: str) -> str:
    """Return the first word of a mode's title, for narrow columns and charts."""
    return mode_title(mode).split(" ")[0]


def mode_name(mode: str) -> str:
    """Return the name of a mode for a sentence."""
    return MODE_NAMES.get(mode, mode)


def task_title(task: str) -> str:
    """Return the title of a task: `task-1` and `1` are Task 1."""
    return f"Task {task}" if task.isdigit() else task.replace("-", " ").capitalize()
