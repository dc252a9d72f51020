"""One trial as a row: for progress, comparisons, reports and tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from rastrainer.protocol import PROCEDURE_PHASES, RegistrationMethod
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.trial.record import AbortedTrial, AnyTrial

Row = TypeVar("Row", bound="TrialRow")


@dataclass(frozen=True)
class TrialRow:
    """The known facts about one trial; texts are empty if unknown.

    Attributes:
        number: of the trainee's trials in this mode, from 1; 0 for a trial run, or if unknown.
        values: measurements by name; see `rastrainer.study.outcomes`.
        method: by which it was registered, or would have been; scores are compared within one.
        acceptable: whether it was within all limits of its score; False without a score.
        parts: desirability of each part of the score, 0 to 1.
        procedure: None of touches alone, or if it is not scored.
        is_aborted: whether it was aborted after a touch, or can have no score: not passed.
    """

    trainee: str
    mode: str
    task: str
    number: int = 0
    values: Mapping[str, float] = field(default_factory=dict, hash=False)
    trial_id: str = ""
    started_utc: str = ""
    scenario: str = ""
    score_version: str = ""
    acceptable: bool = False
    completed_utc: str = ""
    procedure: ProcedureOutcome | None = None
    method: str = RegistrationMethod.FIDUCIALS.value
    parts: Mapping[str, float] = field(default_factory=dict, hash=False)
    is_aborted: bool = False
    is_in_procedure: bool = False

    @classmethod
    def of(cls: type[Row], record: AnyTrial, **known: Any) -> Row:
        phase = record.phase if isinstance(record, AbortedTrial) else ""
        return cls(
            record.trainee,
            record.mode,
            record.task,
            trial_id=record.trial_id,
            started_utc=record.started_utc,
            scenario=record.scenario,
            method=record.method.value,
            is_aborted=bool(phase),
            is_in_procedure=phase in PROCEDURE_PHASES,
            **known,
        )

    @property
    def score(self) -> float:
        """The latest score, above 0 up to 100; 0 without one."""
        return self.values.get("score", 0.0)
