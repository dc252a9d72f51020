"""The outcomes of trials from `outcomes.json`: title, unit, and which direction is better.

The motion metrics have definitions, too, with their thresholds and sources.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rastrainer.motion import trajectory, trial_motion
from rastrainer.number_text import fixed

FILTER = (
    f"resampled to {trial_motion.RATE_HZ:g} Hz, zero-phase second-order Butterworth low pass at "
    f"{trajectory.CUTOFF_HZ:g} Hz"
)
MODE_TITLES = {"desktop": "Desktop", "hmd": "Headset (HMD)"}
MODE_NAMES = {"desktop": "the desktop screen", "hmd": "the headset"}


@dataclass(frozen=True)
class Outcome:
    """An outcome of a trial; `better` is -1 if less is better, 1 if more is, 0 if neither.

    The definition of a motion metric is one sentence with every threshold; others have none.
    """

    name: str
    title: str
    definition: str = ""
    unit: str = ""
    better: int = 0
    digits: int = 2
    source: str = "RASTrainer"

    @property
    def heading(self) -> str:
        return f"{self.title}, {self.unit}" if self.unit else self.title

    def text(self, value: float) -> str:
        """Return a value with its decimals, without its unit."""
        return fixed(value, self.digits)


def _outcome(values: dict[str, Any]) -> Outcome:
    thresholds = {**vars(trajectory), **vars(trial_motion), "FILTER": FILTER}
    definition = values.pop("definition", "").format_map(thresholds)
    return Outcome(**values, definition=definition)


_FILE = json.loads(Path(__file__).with_name("outcomes.json").read_text(encoding="utf-8"))
MOTION_METRICS = {each["name"]: _outcome(each) for each in _FILE["motion"]}
MAIN_OUTCOMES = (MOTION_METRICS["completion_time_s"], *map(_outcome, _FILE["results"]))
MOTION_OUTCOMES = tuple(
    metric for metric in MOTION_METRICS.values() if metric.name != "completion_time_s"
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
    return MODE_TITLES.get(mode, mode)


def short_mode_title(mode: str) -> str:
    """Return the first word of a mode's title, for narrow columns and charts."""
    return mode_title(mode).split(" ")[0]


def mode_name(mode: str) -> str:
    return MODE_NAMES.get(mode, mode)


def task_title(task: str) -> str:
    return f"Task {task}" if task.isdigit() else task.replace("-", " ").capitalize()
