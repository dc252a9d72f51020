"""The values that a study stores, and its clock."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import datetime, timezone
from typing import Any, TypeVar

import numpy as np

from rastrainer.errors import InputError
from rastrainer.json_checks import decode_finite_json
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import TargetError
from rastrainer.trial.analysis import RevealedTruth
from rastrainer.trial.procedure_outcome import ProcedureOutcome, ProcedureScore
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import TrialScore

Value = TypeVar("Value")


def utc_now() -> str:
    """Return the current time as ISO 8601 in UTC, to the millisecond."""
    return datetime.now(timezone.utc).isoformat(timespec="milliseconds")


def day_of(utc: str) -> str:
    """Return the day of an ISO 8601 time, such as 2026-01-31."""
    return utc[: len("2026-01-31")]


def moment(utc: str) -> datetime:
    """Return the time of an ISO 8601 text; before Python 3.11, `fromisoformat` rejects Z."""
    return datetime.fromisoformat(utc.replace("Z", "+00:00"))


RECORD_LIMIT_BYTES = 2**20
_NULL = re.compile(r"(?<!\\)(?:\\\\)*\\u0000")


def json_text(value: object) -> str:
    """Return a value as ASCII JSON; raise `InputError` if that is impossible.

    Null characters and halves of surrogate pairs are refused: PostgreSQL cannot read JSON with
    them, and a single trial would hide all of its trainee's.
    """
    try:
        text = json.dumps(value, allow_nan=False)
        if "\\ud" in text:
            json.dumps(value, ensure_ascii=False).encode()
        if _NULL.search(text):
            raise ValueError
    except (TypeError, ValueError, RecursionError):
        raise InputError(
            "What a study stores must be JSON with finite numbers and whole characters, none of "
            "them null."
        ) from None
    return text


def record_text(record: Mapping[str, Any]) -> str:
    """Return a record as ASCII JSON; raise `InputError` if that is impossible or above 1 MiB."""
    text = json_text(record)
    if len(text) > RECORD_LIMIT_BYTES:
        raise InputError("The trial record is larger than 1 MiB, the most that is stored.")
    return text


def decoded(text: str, read: Callable[[Any], Value]) -> Value:
    """Return decoded stored JSON; raise `InputError` if it is invalid."""
    try:
        return read(decode_finite_json(text))
    except (TypeError, ValueError, KeyError, AttributeError):
        raise InputError("The study contains a value that RASTrainer did not write.") from None


@dataclass(frozen=True)
class Trainee:
    """A trainee, known only by a pseudonym.

    Attributes:
        consent: Whether the trainee consents to research.
        archived: Whether the trainee is hidden from the list.
        created_utc: ISO 8601.
    """

    pseudonym: str
    consent: bool
    archived: bool
    created_utc: str


@dataclass(frozen=True)
class StoredRegistration:
    """A stored registration of a trial.

    Attributes:
        kind: `rigid`, `similarity` or `affine`.
        labels: Of the points in the fit.
        matrix: 16 numbers row by row, `World` to RAS, mm.
        fre_mm: Fiducial registration error.
        residuals_mm: One for each label.
        warnings: Each with `code`, `points` and `message`.
        target_mm: Target in RAS; None with the next two if the fit gives no target error.
        expected_tre_mm: Expected error there.
        tre_interval_mm: Its 95 % interval.
        common_bias_sd_mm: Standard deviation on each axis of the common offset included in both.
    """

    kind: str
    labels: tuple[str, ...]
    matrix: tuple[float, ...]
    fre_mm: float
    residuals_mm: tuple[float, ...]
    warnings: tuple[dict[str, Any], ...]
    target_mm: tuple[float, float, float] | None
    expected_tre_mm: float | None
    tre_interval_mm: tuple[float, float] | None
    common_bias_sd_mm: float = 0.0

    @classmethod
    def of(cls, registration: Registration, error: TargetError | None) -> StoredRegistration:
        """Return a registration and its target error for storage."""
        return cls(
            kind=registration.kind,
            labels=registration.labels,
            matrix=tuple(map(float, np.ravel(registration.matrix))),
            fre_mm=registration.fre_mm,
            residuals_mm=tuple(map(float, registration.residuals_mm)),
            warnings=tuple(warning.to_json() for warning in registration.warnings),
            target_mm=None if error is None else error.target_mm,
            expected_tre_mm=None if error is None else error.expected_mm,
            tre_interval_mm=None if error is None else error.interval_mm,
            common_bias_sd_mm=0.0 if error is None else error.common_bias_sd_mm,
        )

    def to_json(self) -> dict[str, Any]:
        return dict(vars(self))

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> StoredRegistration:
        """Return the registration that `to_json` described."""
        fields: dict[str, Any] = {
            name: tuple(item) if isinstance(item, list) else item for name, item in value.items()
        }
        return cls(**fields)


@dataclass(frozen=True)
class TrialOutcome:
    """Outcomes for comparing trials.

    Attributes:
        trial_id: UUID.
        trainee: Pseudonym.
        completion_time_s: As recorded.
        score: The latest, or None.
        method: By what it was registered.
        true_tre_mm: None until revealed.
    """

    trial_id: str
    trainee: str
    completion_time_s: float
    score: float | None
    method: str
    true_tre_mm: float | None


@dataclass(frozen=True)
class StoredProcedure:
    """The stored outcome of a procedure.

    Attributes:
        analysis: Its errors, as `ProcedureAnalysis.to_json`.
        score: From them.
    """

    analysis: Mapping[str, Any]
    score: ProcedureScore

    @property
    def self_aligned(self) -> int:
        """On how many trajectories the robot aligned the guide."""
        return sum(bool(one["selfAligned"]) for one in self.trajectories)

    @classmethod
    def of(cls, outcome: ProcedureOutcome) -> StoredProcedure:
        return cls(outcome.analysis.to_json(), outcome.score)

    def to_json(self) -> dict[str, Any]:
        return {"analysis": dict(self.analysis), "score": self.score.to_json()}

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> StoredProcedure:
        """Return the outcome that `to_json` described."""
        return cls(dict(value["analysis"]), ProcedureScore.from_json(value["score"]))

    @property
    def name(self) -> str:
        return str(self.analysis["procedure"])

    @property
    def kind(self) -> str:
        return str(self.analysis["kind"])

    @property
    def trajectories(self) -> tuple[Mapping[str, Any], ...]:
        """The errors of each trajectory, as `TrajectoryErrors.to_json`."""
        return tuple(self.analysis["trajectories"])


@dataclass(frozen=True)
class StoredTrial:
    """A trial with its latest results.

    Attributes:
        record: As delivered by the simulator.
        registrations: By kind.
        score: None until scored.
        true_tre_mm: True error at the target; None until revealed.
        head_to_world: 16 numbers row by row, RAS to `World`, mm; None until revealed.
        motion: Motion metrics by name, with units; may be empty.
        procedure: Outcome of the procedure; None until scored, or of touches alone.
    """

    record: TrialRecord
    registrations: dict[str, StoredRegistration]
    score: TrialScore | None
    true_tre_mm: float | None
    head_to_world: tuple[float, ...] | None
    motion: dict[str, float] = field(default_factory=dict)
    procedure: StoredProcedure | None = None

    @property
    def truth(self) -> RevealedTruth | None:
        """What the simulator revealed; None until then."""
        if self.head_to_world is None or self.true_tre_mm is None:
            return None
        return RevealedTruth(self.head_to_world, self.true_tre_mm)
