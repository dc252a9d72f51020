"""Whether a scored trial is passed, by the details that came with its score."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from rastrainer.json_checks import is_number
from rastrainer.protocol import TRIAL_RUN
from rastrainer.trial.scoring import PASS_MARK, passes

_LIMITS = (
    ("isAccurate", "result.not accurate"),
    ("isUnbiased", "result.not unbiased"),
    ("isSafe", "result.not safe"),
)


def detail_number(details: Mapping[str, Any], name: str) -> float | None:
    """Return a number of a score's details; None for anything else."""
    value = details.get(name)
    return float(value) if is_number(value) and math.isfinite(value) else None


def pass_mark(task: str, details: Mapping[str, Any]) -> float | None:
    """Return the score that passes; None in a trial run, and in a study without a mark."""
    if task == TRIAL_RUN:
        return None
    return detail_number({"passMark": PASS_MARK, **details}, "passMark")


def beyond_limits(details: Mapping[str, Any]) -> list[str]:
    """Return the keys of the sentences that say why a trial is not acceptable."""
    return [key for name, key in _LIMITS if details.get(name) is False]


def is_passed(task: str, score: float, details: Mapping[str, Any]) -> bool | None:
    """Return whether a trial is passed, with its procedure; None without a pass mark."""
    procedure = details.get("procedure")
    is_placed = not isinstance(procedure, dict) or procedure.get("acceptable") is not False
    is_acceptable = is_placed and not beyond_limits(details)
    mark = pass_mark(task, details)
    if mark is None:
        return None if is_acceptable else False
    return passes(score, is_acceptable, mark)
