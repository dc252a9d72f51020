"""What was done in a procedure, as part of a trial's record; it does not hold the truth."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np

from rastrainer import json_checks
from rastrainer.errors import InputError
from rastrainer.files.json_fields import from_json_object, json_object
from rastrainer.head.mesh import RAS_LIMIT_MM
from rastrainer.json_checks import Argument, checked_keys
from rastrainer.procedure.plan import DIAMETERS_MM, MAX_TRAJECTORIES, ProcedureKind
from rastrainer.protocol import FIDUCIAL_COUNT, PROCEDURE_PHASES, WORLD_LIMIT_MM, Phase
from rastrainer.transforms import is_rigid

MAX_ATTEMPTS = 100
MAX_TOUCHED_CHECKPOINTS = 1000
MAX_ALIGNMENTS = 100_000
MAX_FEED_METRICS = 20
DEPTH_LIMIT_MM = 1000.0
_TIME_LIMIT_S = 1e6
_UNIT_WITHIN = 1e-6

_Part = TypeVar("_Part")


@dataclass(frozen=True)
class TouchedCheckpoint:
    """A checkpoint as it was touched.

    Attributes:
        name: of the checkpoint.
        position_mm: of the tip, World, mm.
        error_mm: distance of the tip to the checkpoint by the registration in use, mm.
    """

    name: str
    position_mm: tuple[float, float, float]
    error_mm: float
    sim_time_s: float

    def to_json(self) -> dict[str, Any]:
        """Return the JSON object that `ProcedureRecord.from_json` reads."""
        return {
            "name": self.name,
            "positionMm": list(self.position_mm),
            "errorMm": self.error_mm,
            "simTime": self.sim_time_s,
        }


@dataclass(frozen=True)
class RegisteredTouch:
    """A fiducial's label and the touched position in World, mm."""

    label: str
    position_mm: tuple[float, float, float]


@dataclass(frozen=True)
class UsedRegistration:
    """The registration by which the plan was shown.

    Attributes:
        matrix: WorldToHead, 16 numbers, row by row, rigid, mm.
        expected_tre_mm: at the scenario's target.
    """

    matrix: tuple[float, ...]
    fre_mm: float
    expected_tre_mm: float

    @property
    def world_to_head(self) -> np.ndarray:
        """(4, 4) float, mm, from World to MRI RAS."""
        return np.reshape(self.matrix, (4, 4))


@dataclass(frozen=True)
class RecordedAttempt:
    """One round of touching, registering and verifying.

    Attributes:
        touches: that were registered; may be left out of the accepted one, whose touches are the
            trial's.
        registration: in use; None where the trainee touched again before there was one.
        checkpoints: touched with it, in order.
    """

    touches: tuple[RegisteredTouch, ...]
    registration: UsedRegistration | None
    checkpoints: tuple[TouchedCheckpoint, ...]


@dataclass(frozen=True)
class PlacedInstrument:
    """What was done for one planned trajectory.

    Attributes:
        trajectory: its name.
        entry_ras: planned entry, RAS mm.
        target_ras: planned target, RAS mm.
        diameter_mm: of the instrument.
        guide_tip_mm: tip of the guide as it was locked last, World, mm.
        guide_direction: its axis, a unit vector into the head, World.
        alignments: how often the guide was locked.
        drill_depth_mm: the deepest that the drill was beyond the guide's tip.
        instrument_depth_mm: where the instrument was released, beyond the guide's tip.
        self_aligned: whether the robot brought the guide onto the line, before hands changed it or
            not.
        times_s: by phase, from `aligning` to `inserting`, without pauses.
        feed: metrics of the feed by name, such as the drill's path in mm.
    """

    trajectory: str
    entry_ras: tuple[float, float, float]
    target_ras: tuple[float, float, float]
    diameter_mm: float
    guide_tip_mm: tuple[float, float, float]
    guide_direction: tuple[float, float, float]
    alignments: int
    drill_depth_mm: float
    instrument_depth_mm: float
    self_aligned: bool = False
    times_s: Mapping[str, float] = field(default_factory=dict)
    feed: Mapping[str, float] = field(default_factory=dict)

    def at_depth(self, depth_mm: float) -> np.ndarray:
        """Return the point on the guide's axis at a depth beyond its tip, (3,) float, World, mm."""
        return np.array(self.guide_tip_mm) + depth_mm * np.array(self.guide_direction)


@dataclass(frozen=True)
class ProcedureRecord:
    """The procedure of a finished trial.

    Attributes:
        procedure: its name in the scenario.
        kind: what was done.
        sha256: of the procedure's content, from `Procedure.sha256`.
        duration_s: from the start of the trial to the last release, without pauses.
        attempts: at registering, in order; the last one was accepted.
        instruments: one per planned trajectory, in the order of the plan.
        phase_times_s: by phase, over all attempts and trajectories, without pauses.
    """

    procedure: str
    kind: ProcedureKind
    sha256: str
    duration_s: float
    attempts: tuple[RecordedAttempt, ...]
    instruments: tuple[PlacedInstrument, ...]
    phase_times_s: Mapping[str, float]

    @property
    def accepted(self) -> UsedRegistration:
        registration = self.attempts[-1].registration
        assert registration is not None, "it was checked"
        return registration

    @property
    def alignments(self) -> int:
        """How often the guide was locked, over all trajectories."""
        return sum(instrument.alignments for instrument in self.instruments)

    @classmethod
    def from_json(cls, value: object) -> ProcedureRecord:
        """Return the record that a decoded JSON object holds; unknown keys are ignored."""
        record = from_json_object(cls, value, _RECORD_KEYS, "The procedure's record")
        if record.attempts[-1].registration is None:
            raise InputError("The procedure's record must end with an accepted registration.")
        return record

    def to_json(self) -> dict[str, Any]:
        return json_object(self)


def _rigid_matrix(value: Any) -> tuple[float, ...]:
    """Accept 16 numbers, row by row, of a rigid 4×4 transform in mm.

    Raises:
        ValueError: anything else; the words follow "must be".
    """
    numbers = json_checks.numbers(16, 1e6)(value)
    if not is_rigid(np.reshape(numbers, (4, 4))):
        raise ValueError("a rigid transform, 4×4, row by row, in mm")
    return numbers


def _unit_vector(value: Any) -> tuple[float, ...]:
    numbers = json_checks.numbers(3, 1 + _UNIT_WITHIN)(value)
    if abs(float(np.linalg.norm(numbers)) - 1) > _UNIT_WITHIN:
        raise ValueError("a unit vector")
    return numbers


def _list_of(
    read: Callable[[Any], _Part], least: int, most: int, what: str
) -> Callable[[Any], tuple[_Part, ...]]:
    def check(value: Any) -> tuple[_Part, ...]:
        if not isinstance(value, (list, tuple)) or not least <= len(value) <= most:
            raise ValueError(f"a list of {least} to {most} {what}")
        return tuple(read(item) for item in value)

    return check


def _checkpoint(value: Any) -> TouchedCheckpoint:
    keys = checked_keys(value, _CHECKPOINT_KEYS, "Each checkpoint of the procedure's record")
    return TouchedCheckpoint(keys["name"], keys["positionMm"], keys["errorMm"], keys["simTime"])


def _touch(value: Any) -> RegisteredTouch:
    what = "Each touch of the procedure's record"
    return from_json_object(RegisteredTouch, value, _TOUCH_KEYS, what)


def _registration(value: Any) -> UsedRegistration | None:
    if value is None:
        return None
    what = "Each registration of the procedure's record"
    return from_json_object(UsedRegistration, value, _REGISTRATION_KEYS, what)


def _attempt(value: Any) -> RecordedAttempt:
    what = "Each attempt of the procedure's record"
    return from_json_object(RecordedAttempt, value, _ATTEMPT_KEYS, what)


def _instrument(value: Any) -> PlacedInstrument:
    what = "Each instrument of the procedure's record"
    return from_json_object(PlacedInstrument, value, _INSTRUMENT_KEYS, what)


def _kind(value: Any) -> ProcedureKind:
    return ProcedureKind(_KIND_NAME(value))


_KIND_NAME = json_checks.one_of(*(kind.value for kind in ProcedureKind))
_PHASES = tuple(phase.value for phase in (Phase.RUNNING, *PROCEDURE_PHASES))
_WORLD_POINT = Argument(json_checks.numbers(3, WORLD_LIMIT_MM, "mm"))
_RAS_POINT = Argument(json_checks.numbers(3, RAS_LIMIT_MM, "mm"))
_LENGTH = Argument(json_checks.number(0, 1e6, "mm"))
_DEPTH = Argument(json_checks.number(0, DEPTH_LIMIT_MM, "mm"))
_TIMES = Argument(
    json_checks.mapping(
        len(_PHASES),
        f"numbers from 0 to {_TIME_LIMIT_S:g} for some of {', '.join(_PHASES)}",
        json_checks.number(0, _TIME_LIMIT_S),
        json_checks.one_of(*_PHASES),
    ),
    {},
)
_CHECKPOINT_KEYS = {
    "name": Argument(json_checks.text()),
    "positionMm": _WORLD_POINT,
    "errorMm": _LENGTH,
    "simTime": Argument(json_checks.number(0, _TIME_LIMIT_S, "s")),
}
_TOUCH_KEYS = {"label": Argument(json_checks.text()), "positionMm": _WORLD_POINT}
_REGISTRATION_KEYS = {
    "matrix": Argument(_rigid_matrix),
    "freMm": _LENGTH,
    "expectedTreMm": _LENGTH,
}
_ATTEMPT_KEYS = {
    "touches": Argument(_list_of(_touch, 0, FIDUCIAL_COUNT, "touches"), ()),
    "registration": Argument(_registration),
    "checkpoints": Argument(_list_of(_checkpoint, 0, MAX_TOUCHED_CHECKPOINTS, "checkpoints"), ()),
}
_INSTRUMENT_KEYS = {
    "trajectory": Argument(json_checks.text()),
    "entryRas": _RAS_POINT,
    "targetRas": _RAS_POINT,
    "diameterMm": Argument(json_checks.number(*DIAMETERS_MM, "mm")),
    "guideTipMm": _WORLD_POINT,
    "guideDirection": Argument(_unit_vector),
    "alignments": Argument(json_checks.whole_number(1, MAX_ALIGNMENTS)),
    "drillDepthMm": _DEPTH,
    "instrumentDepthMm": _DEPTH,
    "selfAligned": Argument(json_checks.yes_or_no, False),
    "timesS": _TIMES,
    "feed": Argument(
        json_checks.mapping(
            MAX_FEED_METRICS, "numbers from 0 to 1e+09", json_checks.number(0, 1e9)
        ),
        {},
    ),
}
_RECORD_KEYS = {
    "procedure": Argument(json_checks.text(40)),
    "kind": Argument(_kind),
    "sha256": Argument(json_checks.text(64)),
    "durationS": Argument(json_checks.number(0, _TIME_LIMIT_S, "s")),
    "attempts": Argument(_list_of(_attempt, 1, MAX_ATTEMPTS, "attempts")),
    "instruments": Argument(_list_of(_instrument, 1, MAX_TRAJECTORIES, "instruments")),
    "phaseTimesS": _TIMES,
}
