"""The values that a study stores, and its clock."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timezone
from functools import partial
from typing import Annotated, Any, TypeVar

import numpy as np

from rastrainer.errors import InputError
from rastrainer.json_checks import decode_finite_json, number, numbers, plain_object, text
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import TargetError
from rastrainer.trial.analysis import RevealedTruth
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import TrialScore

Value = TypeVar("Value")


def utc_now() -> str:
    return datetime.now(timezone.utc).isoformat(timespec="milliseconds")


def day_of(utc: str) -> str:
    return utc[: len("2026-01-31")]


def moment(utc: str) -> datetime:
    """Return the time of an ISO 8601 text; before Python 3.11, `fromisoformat` rejects Z."""
    return datetime.fromisoformat(utc.replace("Z", "+00:00"))


_NULL = re.compile(r"(?<!\\)(?:\\\\)*\\u0000")


def json_text(value: object) -> str:
    """Return a value as ASCII JSON; raise `InputError` if that is impossible.

    Null characters and halves of surrogate pairs are refused: PostgreSQL cannot read JSON with
    them, and a single trial would hide all of its trainee's.
    """
    try:
        written = json.dumps(value, allow_nan=False)
        if "\\ud" in written:
            json.dumps(value, ensure_ascii=False).encode()
        if _NULL.search(written):
            raise ValueError
    except (TypeError, ValueError, RecursionError):
        raise InputError(
            "What a study stores must be JSON with finite numbers and whole characters, none of "
            "them null."
        ) from None
    return written


def decoded(written: str, read: Callable[[Any], Value]) -> Value:
    try:
        return read(decode_finite_json(written))
    except (TypeError, ValueError, KeyError, AttributeError):
        raise InputError("The study contains a value that RASTrainer did not write.") from None


def decoded_record(kind: type[Value], written: str) -> Value:
    return decoded(written, partial(record_from_json, kind))


def result_of(kind: str, written: str) -> Any:
    """Return a stored result; every kind outside `RESULTS` is a registration's."""
    return decoded_record(RESULTS.get(kind, StoredRegistration), written)


@dataclass(frozen=True)
class Trainee:
    """A trainee, known only by a pseudonym; the list hides archived trainees."""

    pseudonym: str
    consent: bool
    archived: bool
    created_utc: str


_LIMIT = 1e9
_Length = Annotated[float, number(0, _LIMIT, "mm")]


@dataclass(frozen=True)
class StoredRegistration:
    """A stored registration of a trial: `World` to RAS, mm, its matrix row by row.

    Target, expected TRE and interval are None if the fit gives no target error; both include a
    common offset of `common_bias_sd_mm` on each axis.
    """

    kind: Annotated[str, text(20)]
    labels: tuple[Annotated[str, text()], ...]
    matrix: Annotated[tuple[float, ...], numbers(16, _LIMIT)]
    fre_mm: _Length
    residuals_mm: tuple[_Length, ...]
    warnings: tuple[Annotated[dict[str, Any], plain_object], ...]
    target_mm: Annotated[tuple[float, float, float] | None, numbers(3, _LIMIT)]
    expected_tre_mm: Annotated[float | None, number(0, _LIMIT)]
    tre_interval_mm: Annotated[tuple[float, float] | None, numbers(2, _LIMIT)]
    common_bias_sd_mm: _Length = 0.0

    @classmethod
    def of(cls, registration: Registration, error: TargetError | None) -> StoredRegistration:
        return cls(
            kind=registration.kind,
            labels=registration.labels,
            matrix=tuple(map(float, np.ravel(registration.matrix))),
            fre_mm=registration.fre_mm,
            residuals_mm=tuple(map(float, registration.residuals_mm)),
            warnings=tuple(record_to_json(warning) for warning in registration.warnings),
            target_mm=None if error is None else error.target_mm,
            expected_tre_mm=None if error is None else error.expected_mm,
            tre_interval_mm=None if error is None else error.interval_mm,
            common_bias_sd_mm=0.0 if error is None else error.common_bias_sd_mm,
        )


@dataclass(frozen=True)
class StoredTrial:
    """A trial with its latest results, as far as they are known; registrations by kind."""

    record: TrialRecord
    registrations: dict[str, StoredRegistration]
    score: TrialScore | None = None
    truth: RevealedTruth | None = None
    procedure: ProcedureOutcome | None = None

    @property
    def true_tre_mm(self) -> float | None:
        """True error at the target; None until it is revealed."""
        return None if self.truth is None else self.truth.true_tre_mm


SCORE, PROCEDURE, TRUTH = "score", "procedure", "truth"
RESULTS = {SCORE: TrialScore, PROCEDURE: ProcedureOutcome, TRUTH: RevealedTruth}
"""The kinds of results other than registrations."""
