"""CTPS of every trial of a report, and CTPS tables by mode."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from rastrainer.ctps import (
    CohortReference,
    CohortScores,
    published_ctps,
    score_cohort,
    task_number,
)
from rastrainer.errors import InputError
from rastrainer.inference.correlation import Correlation, correlation
from rastrainer.report.study_data import StudyData, TrialRow


def with_ctps(data: StudyData) -> StudyData:
    """Return the study with `ctps` among the values of each trial that has a registration."""
    references = {}
    for mode in data.modes:
        scores = cohort_scores(data, mode)
        if scores is not None:
            references[mode] = scores.reference
    return replace(
        data, trials=tuple(_with_ctps(trial, references.get(trial.mode)) for trial in data.trials)
    )


def cohort_scores(data: StudyData, mode: str) -> CohortScores | None:
    """Return the CTPS table of a mode; None where its trials give no reference."""
    try:
        return score_cohort(data.ctps_trials(mode), data.mean_ct_s.get(mode))
    except InputError:
        return None


def complexity_correlation(values: Iterable[tuple[str, float]]) -> Correlation | None:
    """Return how values of tasks (name, value) go with the tasks' numbers; None of too few."""
    pairs = [(task_number(task), value) for task, value in values]
    numbered = [pair for pair in pairs if pair[0] is not None]
    try:
        return correlation(*zip(*numbered, strict=True)) if numbered else None
    except InputError:
        return None


def _with_ctps(trial: TrialRow, reference: CohortReference | None) -> TrialRow:
    if reference is None or "rmse_mm" not in trial.values:
        return trial
    ctps = published_ctps(trial.values["completion_time_s"], trial.values["rmse_mm"], reference)
    return replace(trial, values={**trial.values, "ctps": ctps})
