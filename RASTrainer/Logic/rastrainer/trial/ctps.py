"""CTPS, the Combined Task Performance Score of the paper that RASTrainer implements.

Equations 1 and 2: CT score = CT / mean CT and RMSE penalty = (RMSE − best RMSE) / best RMSE, mean
and best taken over all trials of a mode. The paper's Tables I and II hold 100·(CT score − RMSE
penalty); its equation 3 divides that by 2. Both forms are here under these names.

The trials of a published study are read from a CSV file, and notes on it from a second file.
"""

from __future__ import annotations

import math
import os
import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.csv_table import number_in, read_table
from rastrainer.files.reading import read_record
from rastrainer.json_checks import list_of, number, one_of, text
from rastrainer.trial.trial_row import TrialRow

TIME, RMSE = "completion_time_s", "rmse_mm"
"""What CTPS is computed from: a trial's time, and the fiducial registration error of its fit."""
PUBLISHED_STUDY = ("studies", "published.csv")
"""Place among the assets of the published study's trials, with which CTPS compares."""

CTPS_WARNING = (
    "CTPS rises with a slower completion, depends on who else is in the cohort and has no bounds; "
    "it is shown because it is published, not to judge a trainee."
)


@dataclass(frozen=True)
class CohortReference:
    """What CTPS compares a trial with: mean CT in s and best RMSE in mm of all trials of a mode."""

    mean_ct_s: float
    best_rmse_mm: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.mean_ct_s) and self.mean_ct_s > 0):
            raise InputError("The mean completion time must be a number of seconds above 0.")
        if not (math.isfinite(self.best_rmse_mm) and self.best_rmse_mm > 0):
            raise InputError("CTPS divides by the best RMSE, which must be above 0 mm.")

    @classmethod
    def of(cls, trials: Sequence[TrialRow], mean_ct_s: float | None = None) -> CohortReference:
        if not trials:
            raise InputError("CTPS needs at least one trial.")
        if mean_ct_s is None:
            mean_ct_s = float(np.mean([trial.values[TIME] for trial in trials]))
        return cls(mean_ct_s, min(trial.values[RMSE] for trial in trials))


@dataclass(frozen=True)
class CohortScores:
    """CTPS of one mode as the paper tabulates it; where too few trials define a value it is None.

    Attributes:
        trials: Published CTPS of each trial, in the order given; the means of tasks and subjects
            are "Task Perf." and "User Perf.".
        sd_population, sd_sample: Standard deviations of `trials`, divided by n and by n − 1.
        pearson_r: Correlation of task number and mean CT of the task, which the paper calls R².
    """

    reference: CohortReference
    trials: tuple[float, ...]
    tasks: dict[str, float]
    subjects: dict[str, float]
    overall: float
    equation_3_overall: float
    sd_population: float
    sd_sample: float | None
    pearson_r: float | None
    r_squared: float | None


def published_ctps(completion_time_s: float, rmse_mm: float, reference: CohortReference) -> float:
    """Return 100·(CT score − RMSE penalty) of one trial, from which the paper's tables follow."""
    ct_score = completion_time_s / reference.mean_ct_s
    rmse_penalty = (rmse_mm - reference.best_rmse_mm) / reference.best_rmse_mm
    return 100 * (ct_score - rmse_penalty)


def score_cohort(trials: Sequence[TrialRow], mean_ct_s: float | None = None) -> CohortScores:
    """Return the CTPS table of the trials of one mode.

    A mean CT can be given instead of the trials' own; the paper used a rounded one.
    """
    reference = CohortReference.of(trials, mean_ct_s)
    scores = [published_ctps(t.values[TIME], t.values[RMSE], reference) for t in trials]
    r = _task_correlation(trials)
    return CohortScores(
        reference=reference,
        trials=tuple(scores),
        tasks=_means(trials, scores, lambda trial: trial.task),
        subjects=_means(trials, scores, lambda trial: trial.trainee),
        overall=float(np.mean(scores)),
        equation_3_overall=float(np.mean(scores)) / 2,
        sd_population=float(np.std(scores)),
        sd_sample=float(np.std(scores, ddof=1)) if len(scores) > 1 else None,
        pearson_r=r,
        r_squared=None if r is None else r * r,
    )


def trials_by_mode(trials: Iterable[TrialRow]) -> dict[str, list[TrialRow]]:
    modes: dict[str, list[TrialRow]] = {}
    for trial in trials:
        modes.setdefault(trial.mode, []).append(trial)
    return modes


def _means(
    trials: Sequence[TrialRow], values: Sequence[float], key: Callable[[TrialRow], str]
) -> dict[str, float]:
    groups: dict[str, list[float]] = {}
    for trial, value in zip(trials, values, strict=True):
        groups.setdefault(key(trial), []).append(value)
    return {name: float(np.mean(group)) for name, group in groups.items()}


def task_number(task: str) -> int | None:
    """Return the number at the end of a task's name, by which the paper orders complexity."""
    match = re.search(r"[0-9]{1,9}$", task)
    return int(match.group()) if match else None


def _task_correlation(trials: Sequence[TrialRow]) -> float | None:
    """Return Pearson's r of task number and task-mean CT; tasks without a number do not count.

    None if there are fewer than three, or none takes longer than another.
    """
    times = [trial.values[TIME] for trial in trials]
    means = {
        number: mean
        for task, mean in _means(trials, times, lambda trial: trial.task).items()
        if (number := task_number(task)) is not None
    }
    if len(means) < 3 or not np.ptp(list(means.values())) > 0:
        return None
    return float(np.corrcoef(list(means), list(means.values()))[0, 1])


TEXT_LIMIT = 64
NUMBER_LIMIT = 1e6


def read_trials(path: str | os.PathLike[str]) -> list[TrialRow]:
    """Return the trials of a file, one a row: `ct` in s above 0, `rmse` in mm, 0 or above."""
    trials: list[TrialRow] = []
    counts: Counter[tuple[str, str]] = Counter()
    for line, cells in read_table(path).rows(("mode", "subject", "task", "ct", "rmse")):
        for column in ("mode", "subject", "task"):
            if not 1 <= len(cells[column]) <= TEXT_LIMIT or not cells[column].isprintable():
                raise InputError(
                    f"Line {line} of {path}: {column} must be printable text of 1 to {TEXT_LIMIT} "
                    "characters."
                )
        time_s = number_in(path, line, cells, "ct", 0, NUMBER_LIMIT)
        if time_s == 0:
            raise InputError(f"Line {line} of {path}: ct must be above 0 s.")
        rmse_mm = number_in(path, line, cells, "rmse", 0, NUMBER_LIMIT)
        mode, who = cells["mode"], cells["subject"]
        counts[mode, who] += 1
        values = {TIME: time_s, RMSE: rmse_mm}
        trials.append(TrialRow(who, mode, cells["task"], counts[mode, who], values))
    return trials


QUANTITIES = (
    "overall",
    "equation_3_overall",
    "sd_population",
    "sd_sample",
    "pearson_r",
    "r_squared",
    "mean_ct",
    "mean_rmse",
)


@dataclass(frozen=True)
class Printed:
    """A number printed in a paper, and the computed quantity that it should equal."""

    what: Annotated[str, text(100)]
    mode: str
    quantity: Annotated[str, one_of(*QUANTITIES)]
    printed: Annotated[str, text(20)]


@dataclass(frozen=True)
class Inconsistency:
    """A sentence about numbers that do not fit each other."""

    sentence: Annotated[str, text(1000)]


@dataclass(frozen=True)
class Claim:
    """A claim of a paper's authors, and what its numbers say to it."""

    claim: Annotated[str, text(400)]
    numbers: Annotated[str, text(1000)]


@dataclass(frozen=True)
class StudyNotes:
    """Notes on a study; the mean completion times are those that the authors used, by mode."""

    title: Annotated[str, text(200)]
    source: Annotated[str, text(400)]
    participants: Annotated[str, text(400)]
    setting: Annotated[str, text(1000)]
    mean_ct_s: Mapping[str, Annotated[float, number(0.001, 1e6)]]
    printed: Annotated[tuple[Printed, ...], list_of(0, 50)]
    inconsistencies: Annotated[tuple[Inconsistency, ...], list_of(0, 50)]
    claims: Annotated[tuple[Claim, ...], list_of(0, 50)]


def read_notes(path: Path) -> StudyNotes | None:
    return read_record(StudyNotes, path) if path.exists() else None
