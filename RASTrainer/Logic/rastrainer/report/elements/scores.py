"""The scores in a report: CTPS by trial and mode, and RASTrainer's own of one version."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from rastrainer.errors import InputError
from rastrainer.number_text import counted
from rastrainer.statistics.intervals import Correlation, correlation
from rastrainer.study.study_data import StudyData, TrialRow
from rastrainer.trial.ctps import (
    CohortReference,
    CohortScores,
    published_ctps,
    score_cohort,
    task_number,
)


def with_ctps(data: StudyData) -> StudyData:
    """Return the study with `ctps` in the values of each registered trial."""
    references = {}
    for mode in data.modes:
        scores = cohort_scores(data, mode)
        if scores is not None:
            references[mode] = scores.reference
    return replace(
        data, trials=tuple(_with_ctps(trial, references.get(trial.mode)) for trial in data.trials)
    )


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


def _with_ctps(trial: TrialRow, reference: CohortReference | None) -> TrialRow:
    if reference is None or "rmse_mm" not in trial.values:
        return trial
    ctps = published_ctps(trial.values["completion_time_s"], trial.values["rmse_mm"], reference)
    return replace(trial, values={**trial.values, "ctps": ctps})


SCORE = "score"


def with_one_score_version(data: StudyData) -> StudyData:
    """Return the study with scores of its latest version only.

    All trials are kept, with their times, errors and score versions.
    """
    latest = max((trial.score_version for trial in data.trials), key=_order, default="")
    return replace(data, trials=tuple(_with_score_of(trial, latest) for trial in data.trials))


def compared_version(data: StudyData) -> str:
    """Return the version of the compared scores; "" if there are none."""
    return next((trial.score_version for trial in data.trials if SCORE in trial.values), "")


def versions_note(data: StudyData) -> str:
    """Return which scores `with_one_score_version` left out; "" if none."""
    compared = compared_version(data)
    left_out = Counter(
        trial.score_version for trial in data.trials if trial.score_version not in ("", compared)
    )
    if not left_out:
        return ""
    own = sum(SCORE in trial.values for trial in data.trials)
    others = " and ".join(
        f"{counted(count, 'trial')} of version {version}"
        for version, count in sorted(left_out.items())
    )
    return (
        "This study has scores of several versions, which measure different things and cannot be "
        f"compared: {counted(own, 'trial')} of version {compared}, {others}. Wherever this report "
        f"reports scores, trials passed or competence, it means version {compared} alone. "
        "trials.csv has all of them, each with its version."
    )


def _with_score_of(trial: TrialRow, version: str) -> TrialRow:
    if trial.score_version == version or SCORE not in trial.values:
        return trial
    values = {name: value for name, value in trial.values.items() if not name.startswith(SCORE)}
    return replace(trial, values=values)


def _order(version: str) -> tuple[int, str]:
    """Return a sort key: 10 comes after 9."""
    return (int(version) if version.isdecimal() else 0, version)
