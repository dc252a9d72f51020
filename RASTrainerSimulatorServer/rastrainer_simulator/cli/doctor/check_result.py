"""The result of one check."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class CheckStatus(str, Enum):
    """The verdict: with a warning a feature is missing, with a problem training is impossible."""

    OK = "ok"
    WARNING = "warning"
    PROBLEM = "problem"


@dataclass(frozen=True)
class CheckResult:
    """One line of the doctor.

    Attributes:
        check: what was checked, such as "ports".
        verdict: ok, warning or problem.
        sentence: what was found.
        remedy: what to do; "" if nothing.
    """

    check: str
    verdict: CheckStatus
    sentence: str
    remedy: str = ""
