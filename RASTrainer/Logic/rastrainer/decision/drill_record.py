"""The record of a drill of decisions, as delivered by the simulator and stored.

A case is a finished registration with a fault or without; the trainee checks places on the head,
reads the images, and decides whether to proceed. The record holds the truth that the trainee is
told after each decision.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Annotated

from rastrainer import json_checks
from rastrainer.protocol import DECIDE, NUMBER_LIMIT, Mode, RegistrationMethod
from rastrainer.trial.record import VERSIONS_LIMIT, Utc

CASES = 20
"""Number of cases in a drill."""
CASE_S = 120.0
"""Time for a case. When it is over, the trainee must decide without further checks."""
CHECK_S = 10.0
"""Time that each check takes from the case's clock."""
MAX_CHECKS = int(CASE_S / CHECK_S)
CONFIDENCES = (50, 60, 70, 80, 90, 100)
"""Stated probability that the decision is right, percent."""


class Decision(str, Enum):
    """What to do with a registration."""

    PROCEED = "proceed"
    REGISTER_AGAIN = "register again"
    STOP = "stop"


class Fault(str, Enum):
    """The cause of a case's error.

    The error of a repeatable fault is gone after another registration; the cause of any other has
    to be found first. A case whose error is at the limit has the difficulty, logits.
    """

    is_repeatable: bool
    difficulty: float

    NONE = "none", True, -1.5
    BAD_FIDUCIAL = "bad fiducial", True, -1.5
    SWAPPED = "swapped fiducials", True, -1.6
    SLID_TRACE = "slid trace", True, -1.6
    MOVED_HEAD = "moved head", True, -1.5
    MIRRORED = "mirrored images", False, -5.0
    SCALED = "wrong scale", False, -1.8
    FAR_FIDUCIALS = "far fiducials", False, -1.5
    BENT_TOOL = "bent tool", False, -1.3
    SHIFTED_SKIN = "shifted skin", False, -1.0
    OTHER_PATIENT = "other patient", False, -1.7

    def __new__(cls, value: str, is_repeatable: bool, difficulty: float) -> Fault:
        fault = str.__new__(cls, value)
        fault._value_, fault.is_repeatable, fault.difficulty = value, is_repeatable, difficulty
        return fault


FAULTS = tuple(fault for fault in Fault if fault is not Fault.NONE)

_Seconds = Annotated[float, json_checks.number(0, 1e6, "s")]
_Millimeters = Annotated[float, json_checks.number(0, 1e4, "mm")]


@dataclass(frozen=True, kw_only=True)
class CaseTruth:
    """The truth about a case, and the shown figures of its registration.

    Attributes:
        seed: never drawn twice for a trainee.
        limit_mm: largest acceptable error at the target.
        residual_mm: root mean square, of the touched points (FRE) or of the trace.
        difficulty: of a Rasch model, logits: a trainee whose ability equals it is right in half.
    """

    seed: Annotated[int, json_checks.whole_number(0, 2**63 - 1)]
    fault: Fault
    method: RegistrationMethod
    limit_mm: _Millimeters
    true_error_mm: _Millimeters
    expected_error_mm: _Millimeters
    residual_mm: _Millimeters
    difficulty: Annotated[float, json_checks.number(-20, 20)]

    @property
    def is_sound(self) -> bool:
        """Whether the true error is within the limit, with a fault or without."""
        return self.true_error_mm <= self.limit_mm


@dataclass(frozen=True, kw_only=True)
class DecidedCase(CaseTruth):
    """A case of a drill, with the trainee's decision.

    Attributes:
        checks: names of the checked places, in order; "tip" is where the trainee held the tip.
        confidence: stated probability that the decision is right, percent.
        suspected: cause that the trainee suspects; None after `proceed`.
        time_s: simulated time from the case's start to the decision, with the checks' time.
    """

    checks: Annotated[tuple[str, ...], json_checks.list_of(0, MAX_CHECKS, "checks")] = ()
    has_read_images: bool = False
    decision: Decision
    confidence: Annotated[int, json_checks.whole_number(50, 100)]
    suspected: Fault | None = None
    time_s: _Seconds

    @property
    def is_right(self) -> bool:
        return (self.decision is Decision.PROCEED) == self.is_sound


@dataclass(frozen=True, kw_only=True)
class DrillRecord:
    """A finished drill of decisions.

    Attributes:
        trial_id: UUID, under which it is delivered and stored once, as a trial is.
        journal_sha256, number, series: as of a trial's record; drills are numbered apart.
    """

    trial_id: Annotated[str, json_checks.trial_id]
    trainee: Annotated[str, json_checks.pseudonym]
    mode: Annotated[str, json_checks.one_of(*(mode.value for mode in Mode))]
    scenario: str
    started_utc: Utc
    completed_utc: Utc
    cases: Annotated[tuple[DecidedCase, ...], json_checks.list_of(1, 100, "cases")]
    versions: Annotated[Mapping[str, str], json_checks.object_of(VERSIONS_LIMIT)] = field(
        default_factory=dict
    )
    journal_sha256: Annotated[str, json_checks.text(64, 0)] = ""
    number: Annotated[int, json_checks.whole_number(0, NUMBER_LIMIT)] = 0
    series: Annotated[str, json_checks.text(36, 0)] = ""

    @property
    def task(self) -> str:
        return DECIDE

    @property
    def record(self) -> DrillRecord:
        """The drill itself: it has no results besides, as a stored trial has."""
        return self
