"""Which of a trainee's trials makes the grade in a course."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from enum import Enum

from rastrainer.protocol import RegistrationMethod
from rastrainer.study.platform_links import LinkedAssignment
from rastrainer.trial.scoring import score_version
from rastrainer.trial.trainee_progress import PastTrial


class GradeRule(str, Enum):
    """Which acceptable trial counts."""

    BEST = "best"
    LATEST = "latest"


@dataclasses.dataclass(frozen=True)
class GradeTerms:
    """What a link of a course asks for.

    Attributes:
        task, mode: Of the trials that count; "" for any.
        method: Of their registration: scores of different methods are not compared.
        rule: Which of them counts.
    """

    task: str
    mode: str
    method: RegistrationMethod
    rule: GradeRule

    @classmethod
    def of(cls, stored: LinkedAssignment) -> GradeTerms:
        """Return the terms of a stored assignment."""
        method, rule = RegistrationMethod(stored.method), GradeRule(stored.rule)
        return cls(stored.task, stored.mode, method, rule)

    def grade(self, trials: Iterable[PastTrial]) -> float | None:
        """Return the score of the trial that counts, 0 to 100; None without an acceptable one.

        A trial that is not acceptable gives no grade: its registration would have misled an
        instrument.

        Args:
            trials: Scored ones of one trainee, in order of starting.
        """
        version = score_version(self.method)
        scores = [
            trial.score
            for trial in trials
            if trial.acceptable
            and trial.score_version == version
            and self.task in ("", trial.task)
            and self.mode in ("", trial.mode)
        ]
        if not scores:
            return None
        return max(scores) if self.rule is GradeRule.BEST else scores[-1]
