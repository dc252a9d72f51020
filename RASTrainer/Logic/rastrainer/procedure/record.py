"""The record of a procedure, a part of the record of its trial; it does not hold the truth."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import RAS_LIMIT_MM
from rastrainer.json_checks import list_of, number, numbers, object_of, one_of, text, whole_number
from rastrainer.procedure.plan import DIAMETERS_MM, MAX_TRAJECTORIES, ProcedureKind
from rastrainer.protocol import FIDUCIAL_COUNT, PROCEDURE_PHASES, WORLD_LIMIT_MM, Phase
from rastrainer.transforms import is_rigid

MAX_ATTEMPTS = 100
MAX_TOUCHED_CHECKPOINTS = 1000
MAX_ALIGNMENTS = 100_000
MAX_FEED_METRICS = 20
DEPTH_LIMIT_MM = 1000.0
TIME_LIMIT_S = 1e6
_UNIT_WITHIN = 1e-6


def _rigid_matrix(value: Any) -> tuple[float, ...]:
    matrix = numbers(16, 1e6)(value)
    if not is_rigid(np.reshape(matrix, (4, 4))):
        raise ValueError("a rigid transform, 4×4, row by row, in mm")
    return matrix


def _unit_vector(value: Any) -> tuple[float, ...]:
    vector = numbers(3, 1 + _UNIT_WITHIN)(value)
    if abs(float(np.linalg.norm(vector)) - 1) > _UNIT_WITHIN:
        raise ValueError("a unit vector")
    return vector


Seconds = Annotated[float, number(0, TIME_LIMIT_S, "s")]
WorldPoint = Annotated[tuple[float, float, float], numbers(3, WORLD_LIMIT_MM, "mm")]
_RasPoint = Annotated[tuple[float, float, float], numbers(3, RAS_LIMIT_MM, "mm")]
_Length = Annotated[float, number(0, 1e6, "mm")]
_Depth = Annotated[float, number(0, DEPTH_LIMIT_MM, "mm")]
PhaseTimes = Annotated[
    Mapping[str, Seconds],
    object_of(check_name=one_of(*(each.value for each in (Phase.RUNNING, *PROCEDURE_PHASES)))),
]


@dataclass(frozen=True)
class TouchedCheckpoint:
    """A checkpoint as it was touched: position of the tip (World), and its distance to the
    checkpoint by the registration in use."""

    name: str
    position_mm: WorldPoint
    error_mm: _Length
    sim_time_s: Seconds


@dataclass(frozen=True)
class RegisteredTouch:
    """A fiducial's label and the touched position in World, mm."""

    label: str
    position_mm: WorldPoint


SAME = 1e-9
"""Registrations are the same up to this part of a number, and up to as many mm."""


@dataclass(frozen=True)
class UsedRegistration:
    """A registration by its numbers: one by which the plan is shown, or the final one of a trial.

    WorldToHead is rigid in a record. The TRE is expected at the scenario's target.
    """

    matrix: Annotated[tuple[float, ...], _rigid_matrix]
    fre_mm: _Length
    expected_tre_mm: _Length

    @classmethod
    def from_arguments(cls, arguments: Mapping[str, Any]) -> UsedRegistration:
        return cls(tuple(arguments["matrix"]), arguments["freMm"], arguments["expectedTreMm"])

    def agrees_with(self, other: UsedRegistration) -> bool:
        """Return whether both are the outcome of one computation.

        Slicer's numpy and the simulator's may round the last digits otherwise; who knows the truth
        gains nothing from so little.
        """
        sides = ((*each.matrix, each.fre_mm, each.expected_tre_mm) for each in (self, other))
        pairs = zip(*sides, strict=True)
        return all(math.isclose(a, b, rel_tol=SAME, abs_tol=SAME) for a, b in pairs)

    @property
    def world_to_head(self) -> np.ndarray:
        """(4, 4) float, mm, from World to MRI RAS."""
        return np.reshape(self.matrix, (4, 4))


@dataclass(frozen=True)
class RecordedAttempt:
    """One round of touching, registering and verifying.

    Registered touches may be left out of the accepted one: they are the trial's.
    """

    touches: Annotated[tuple[RegisteredTouch, ...], list_of(0, FIDUCIAL_COUNT, "touches")] = ()
    registration: UsedRegistration | None = None
    checkpoints: Annotated[
        tuple[TouchedCheckpoint, ...], list_of(0, MAX_TOUCHED_CHECKPOINTS, "checkpoints")
    ] = ()


@dataclass(frozen=True)
class PlacedInstrument:
    """The instrument of one planned trajectory, as it was placed.

    Attributes:
        guide_tip_mm: tip of the guide as it was locked last, World.
        guide_direction: a unit vector into the head, World.
        drill_depth_mm: the deepest that the drill was beyond the guide's tip.
        instrument_depth_mm: where the instrument was released, beyond the guide's tip.
        self_aligned: whether the robot brought the guide onto the line, before hands changed it or
            not.
        times_s: by phase, from `aligning` to `inserting`, without pauses.
        feed: metrics of the feed by name, such as the drill's path in mm.
    """

    trajectory: str
    entry_ras: _RasPoint
    target_ras: _RasPoint
    diameter_mm: Annotated[float, number(*DIAMETERS_MM, "mm")]
    guide_tip_mm: WorldPoint
    guide_direction: Annotated[tuple[float, float, float], _unit_vector]
    alignments: Annotated[int, whole_number(1, MAX_ALIGNMENTS)]
    drill_depth_mm: _Depth
    instrument_depth_mm: _Depth
    self_aligned: bool = False
    times_s: PhaseTimes = field(default_factory=dict)
    feed: Annotated[Mapping[str, Annotated[float, number(0, 1e9)]], object_of(MAX_FEED_METRICS)] = (
        field(default_factory=dict)
    )

    def at_depth(self, depth_mm: float) -> np.ndarray:
        """Return the point on the guide's axis at a depth beyond its tip, (3,) float, World, mm."""
        return np.array(self.guide_tip_mm) + depth_mm * np.array(self.guide_direction)


@dataclass(frozen=True)
class ProcedureRecord:
    """The procedure of a finished trial.

    Attributes:
        sha256: of the procedure's content, from `Procedure.sha256`.
        duration_s: from the start of the trial to the last release, without pauses.
        attempts: at registering; the last one was accepted.
        instruments: one per planned trajectory, in the order of the plan.
        phase_times_s: by phase, over all attempts and trajectories, without pauses.
    """

    procedure: Annotated[str, text(40)]
    kind: ProcedureKind
    sha256: str
    duration_s: Seconds
    attempts: Annotated[tuple[RecordedAttempt, ...], list_of(1, MAX_ATTEMPTS, "attempts")]
    instruments: Annotated[
        tuple[PlacedInstrument, ...], list_of(1, MAX_TRAJECTORIES, "instruments")
    ]
    phase_times_s: PhaseTimes = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.attempts[-1].registration is None:
            raise InputError("The procedure's record must end with an accepted registration.")

    @property
    def accepted(self) -> UsedRegistration:
        registration = self.attempts[-1].registration
        assert registration is not None, "it was checked"
        return registration
