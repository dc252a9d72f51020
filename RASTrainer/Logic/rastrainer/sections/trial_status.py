"""State of the simulator's trial, as its messages say it; they may hold anything."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, TypeVar, cast

from rastrainer.json_checks import is_number
from rastrainer.protocol import (
    FIDUCIAL_COUNT,
    OPEN_PHASES,
    PROCEDURE_PHASES,
    Phase,
    RegistrationMethod,
)

T = TypeVar("T")


@dataclass(frozen=True)
class ProcedureStatus:
    """State of the trial's procedure, everything by the registration in use.

    Attributes:
        name: empty if the trial has no procedure.
        trajectory: number of the current line, from 0.
        entryDistanceMm: of the planned entry from the guide's axis; None without a guide.
        angleDeg: between guide and planned line; None without a guide.
        standOffMm: of the guide's tip from the entry; None without a guide.
        feedMm: how far drill or instrument is beyond the guide's tip.
        lastCheckMm: error at the checkpoint that was touched last; None before.
    """

    name: str = ""
    trajectory: int = 0
    trajectories: int = 0
    registrationInUse: bool = False
    entryDistanceMm: float | None = None
    angleDeg: float | None = None
    standOffMm: float | None = None
    feedMm: float = 0.0
    lastCheckMm: float | None = None


@dataclass(frozen=True)
class TraceStatus:
    """State of the trace over the skin: the number of its points, and whether it is being drawn."""

    kept: int = 0
    strokes: int = 0
    on: bool = False
    isGuided: bool = False


@dataclass(frozen=True)
class TrialStatus:
    """State of the simulator's trial; without one, its phase is `idle`.

    `touched` of `total` points are kept; the trainee reads `instruction`.
    """

    trialId: str = ""
    phase: str = Phase.IDLE.value
    trainee: str = ""
    task: str = ""
    mode: str = ""
    nextPoint: str = ""
    touched: int = 0
    total: int = FIDUCIAL_COUNT
    elapsedS: float = 0.0
    proximity: str = ""
    instruction: str = ""
    method: str = RegistrationMethod.FIDUCIALS.value
    procedure: ProcedureStatus = field(default_factory=ProcedureStatus)
    trace: TraceStatus | None = None

    @property
    def isOpen(self) -> bool:
        """Whether a trial is being played, paused, or waits to be registered."""
        return self.phase in OPEN_PHASES

    @property
    def isProcedureUnderWay(self) -> bool:
        return bool(self.procedure.name) and self.phase in PROCEDURE_PHASES


def readStatus(state: Mapping[str, Any]) -> TrialStatus:
    """Return what a message about the trial says; values of the wrong kind count as missing."""
    trace = state.get("trace")
    return replace(
        _known(TrialStatus, state),
        procedure=_known(ProcedureStatus, state.get("procedure")),
        trace=_known(TraceStatus, trace) if isinstance(trace, Mapping) else None,
    )


def _known(kind: type[T], given: Any) -> T:
    """Return the texts, truth values and numbers of a peer that have their field's kind."""
    values: dict[str, Any] = {}
    for each in fields(cast(Any, kind)):
        value: Any = given.get(each.name) if isinstance(given, Mapping) else None
        if str(each.type).startswith(("int", "float")) and is_number(value):
            values[each.name] = int(value) if each.type == "int" else float(value)
        elif each.type in ("str", "bool") and type(value).__name__ == each.type:
            values[each.name] = value
    return kind(**values)
