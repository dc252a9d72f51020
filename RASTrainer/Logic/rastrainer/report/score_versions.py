"""Scores of one version only: those of different versions do not compare."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from rastrainer.number_text import counted
from rastrainer.report.study_data import StudyData, TrialRow

SCORE = "score"


def with_one_score_version(data: StudyData) -> StudyData:
    """Return the study with the scores of the latest version that it has, and no others.

    The trials stay, with their times, errors and the version of the score that they had.
    """
    latest = max((trial.score_version for trial in data.trials), key=_order, default="")
    return replace(data, trials=tuple(_with_score_of(trial, latest) for trial in data.trials))


def compared_version(data: StudyData) -> str:
    """Return the version of the scores that are compared; "" where there are none."""
    return next((trial.score_version for trial in data.trials if SCORE in trial.values), "")


def versions_note(data: StudyData) -> str:
    """Say which scores `with_one_score_version` has left out; "" where it left out none."""
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
        f"This study has scores of several versions, which measure different things and do not "
        f"compare: {counted(own, 'trial')} of version {compared}, {others}. Wherever this report "
        f"tells of scores, of trials passed or of competence, it is about version {compared} "
        "alone. trials.csv has all of them, each with its version."
    )


def _with_score_of(trial: TrialRow, version: str) -> TrialRow:
    if trial.score_version == version or SCORE not in trial.values:
        return trial
    values = {name: value for name, value in trial.values.items() if not name.startswith(SCORE)}
    return replace(trial, values=values)


def _order(version: str) -> tuple[int, str]:
    """Order versions as numbers, so that 10 comes after 9."""
    return (int(version) if version.isdecimal() else 0, version)
