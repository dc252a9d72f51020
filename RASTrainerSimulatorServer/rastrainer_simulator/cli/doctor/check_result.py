"""What one check has found."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class CheckStatus(str, Enum):
    """How it stands: a warning leaves something out, with a problem nobody can train."""

    OK = "ok"
    WARNING = "warning"
    PROBLEM = "problem"


@dataclass(frozen=True)
class CheckResult:
    """One line of the doctor.

    Attributes:
        check: what was looked at, such as "ports".
        verdict: how it stands.
        sentence: what was found.
        remedy: what to do; "" where nothing is.
    """

    check: str
    verdict: CheckStatus
    sentence: str
    remedy: str = ""
