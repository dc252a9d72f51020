"""The record of a finished trial, as delivered by the simulator and stored in the study."""

from __future__ import annotations

import contextlib
import itertools
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from typing import Any

import numpy as np

from rastrainer import json_checks
from rastrainer.errors import InputError
from rastrainer.files.json_fields import from_json_object, json_object
from rastrainer.head.trial_head import UNMOVED, SkinShift
from rastrainer.json_checks import Argument, checked_keys
from rastrainer.procedure.record import ProcedureRecord
from rastrainer.protocol import (
    COARSE_LANDMARKS,
    FIDUCIAL_COUNT,
    MAX_TRACE_POINTS,
    MIN_TRACE_POINTS,
    PLAYED_METHODS,
    TRACED_METHODS,
    WORLD_LIMIT_MM,
    Mode,
    RegistrationMethod,
    TouchRule,
)
from rastrainer.trial.how_played import HowPlayed

TIME_LIMIT_S = 1e6
TOUCH_LIMIT = 1_000_000
NUMBER_LIMIT = 1_000_000_000
VERSIONS_LIMIT = 32
MOTION_LIMIT = 100
DISPLAY_LIMIT = 16

TracePoint = tuple[float, float, float, float]
"""Position of the tool tip in `World`, in mm, and the simulated time, in s."""


@dataclass(frozen=True)
class TouchedPoint:
    """One fiducial as it was touched.

    Attributes:
        label: The fiducial's label, `1` to `15` in the shipped tasks.
        position_mm: Position of the tool tip in `World`, in mm.
        sim_time_s: Simulated time of the touch, in s.
        utc: Wall time of the touch, ISO 8601 in UTC.
    """

    label: str
    position_mm: tuple[float, float, float]
    sim_time_s: float
    utc: str

    def to_json(self) -> dict[str, Any]:
        """Return the JSON object that `touched_point` reads."""
        return {
            "label": self.label,
            "positionMm": list(self.position_mm),
            "simTime": self.sim_time_s,
            "utc": self.utc,
        }


@dataclass(frozen=True)
class TrialRecord:
    """A finished trial: who, what, when, and the touches that were kept, in their order.

    Attributes:
        trial_id: UUID in its canonical spelling.
        trainee: Pseudonym of the trainee.
        task: Name of the task, such as `task-1`.
        mode: `desktop` or `hmd`.
        scenario: Name of the scenario.
        started_utc: ISO 8601 in UTC; the wall clock may jump, so no duration is taken from it.
        completed_utc: ISO 8601 in UTC.
        completion_time_s: Simulated time from the start to the last kept touch, or the last point
            of the trace, without pauses.
        points: The kept touches, of all fifteen fiducials or of landmarks; their labels differ and
            their times do not fall.
        rejected_touches: Number of touches that were refused (too far off, wrong fiducial).
        undone_touches: Number of touches that the trainee undid.
        versions: Name and version of each program and format that made the record.
        seed: Seed of the trial, where the simulator reveals it.
        touch_rule: Which touches counted, a `TouchRule`.
        motion: Motion metrics by name (`rastrainer.study.outcomes`).
        display: What the trainee looked at: `kind`, `device`, `refreshHz`, `shownFrames` and
            `droppedFrames`, the `guidance` to the next point, and the `ghost` that was shown (a
            `GhostRule`); empty where no view reported it.
        procedure: What was done after the touches; None in a trial of touches alone. The points
            are those of the accepted registration.
        method: How the trial is registered; a `PLAYED_METHODS`.
        trace: The points that were traced over the skin, in order of time; empty where the method
            has no trace.
        skin: how the skin lay on the head, its seed left out; the truth reveals that.
        played: who moved the arm, and more; None of a trial that no simulator recorded.
        number: Of the trial among those of its simulator's folder; 0 if unknown.
        series: UUID of that numbering.
        journal_sha256: Hash of the journal's line of this record, which stands for all lines up to
            it; "" in that line itself.
    """

    trial_id: str
    trainee: str
    task: str
    mode: str
    scenario: str
    started_utc: str
    completed_utc: str
    completion_time_s: float
    points: tuple[TouchedPoint, ...]
    rejected_touches: int
    undone_touches: int
    versions: Mapping[str, str]
    seed: int | None = None
    touch_rule: str = TouchRule.WITHIN_RADIUS.value
    motion: Mapping[str, float] = field(default_factory=dict)
    display: Mapping[str, str | float] = field(default_factory=dict)
    procedure: ProcedureRecord | None = None
    method: RegistrationMethod = RegistrationMethod.FIDUCIALS
    trace: tuple[TracePoint, ...] = ()
    skin: SkinShift = UNMOVED
    played: HowPlayed | None = None
    number: int = 0
    series: str = ""
    journal_sha256: str = ""

    @property
    def labels(self) -> tuple[str, ...]:
        """Labels of the touched points, in the order of touching."""
        return tuple(point.label for point in self.points)

    @property
    def positions_mm(self) -> np.ndarray:
        """Touched points in `World`, (n, 3) float, in mm."""
        return np.array([point.position_mm for point in self.points], dtype=float)

    @property
    def touch_times_s(self) -> np.ndarray:
        """Simulated time of each touch, (n,) float, in s."""
        return np.array([point.sim_time_s for point in self.points], dtype=float)

    @property
    def trace_mm(self) -> np.ndarray:
        """Traced points in `World`, (n, 3) float, in mm."""
        return np.array(self.trace, dtype=float).reshape(-1, 4)[:, :3]

    @classmethod
    def from_json(cls, value: object) -> TrialRecord:
        """Return the record that a decoded JSON object holds.

        Keys that this version does not know are ignored, so that a newer simulator may add some.
        """
        record = from_json_object(cls, value, _CHECKS, "The trial record")
        check_points(record.points)
        _check_method(record)
        return record

    def to_json(self) -> dict[str, Any]:
        """Return the JSON object that `from_json` reads."""
        values = json_object(self) | {"skin": self.skin.amounts}
        # Records of touched fiducials alone stay as they were before there was anything else.
        is_left_out = {
            "procedure": self.procedure is None,
            "method": self.method is RegistrationMethod.FIDUCIALS,
            "trace": not self.trace,
            "skin": self.skin.is_none,
            "played": self.played is None,
            "number": not self.number,
            "series": not self.series,
            "journalSha256": not self.journal_sha256,
        }
        return {key: item for key, item in values.items() if not is_left_out.get(key)}


def utc_time(value: Any) -> str:
    """Accept an ISO 8601 date and time in UTC, such as `2024-05-17T09:30:00.250Z`.

    Raises:
        ValueError: anything else; the words follow "must be".
    """
    try:
        # `fromisoformat` reads the letter Z only from Python 3.11 on.
        moment = datetime.fromisoformat(value.replace("Z", "+00:00"))
    except (AttributeError, TypeError, ValueError):
        moment = None
    if moment is None or moment.utcoffset() != timedelta(0):
        raise ValueError("an ISO 8601 date and time in UTC, such as 2024-05-17T09:30:00Z")
    return value


def touched_point(value: Any) -> TouchedPoint:
    """Return the point that a decoded JSON object holds; raise `InputError` where it is none."""
    point = checked_keys(value, _POINT_KEYS, "Each point of the trial record")
    return TouchedPoint(point["label"], point["positionMm"], point["simTime"], point["utc"])


def points_up_to_all(value: Any) -> tuple[TouchedPoint, ...]:
    """Accept a list of points, no more than a task has fiducials.

    Raises:
        ValueError: anything else; the words follow "must be".
        InputError: one of them is invalid.
    """
    if not isinstance(value, (list, tuple)) or len(value) > FIDUCIAL_COUNT:
        raise ValueError(f"a list of at most {FIDUCIAL_COUNT} points")
    return tuple(touched_point(item) for item in value)


def trace_points(value: Any) -> tuple[TracePoint, ...]:
    """Accept a trace: a list of positions in World with their times, `[x, y, z, simTime]`.

    Raises:
        ValueError: anything else, also where the times fall; the words follow "must be".
    """
    if isinstance(value, (list, tuple)) and len(value) <= MAX_TRACE_POINTS:
        with contextlib.suppress(ValueError, TypeError, LookupError):
            points = tuple(_trace_point(item) for item in value)
            if all(later[3] >= earlier[3] for earlier, later in itertools.pairwise(points)):
                return points
    raise ValueError(
        f"a list of at most {MAX_TRACE_POINTS} points [x, y, z, simTime], mm and s, in order of "
        "time"
    )


def _trace_point(item: Any) -> TracePoint:
    x, y, z, time = item
    x, y, z = _IN_WORLD([x, y, z])
    return x, y, z, _AT_TIME(time)


def _check_method(record: TrialRecord) -> None:
    """Raise `InputError` unless a record has the touches and the trace of its method."""
    method, count = record.method, len(record.points)
    if method is RegistrationMethod.FIDUCIALS and count != FIDUCIAL_COUNT:
        raise InputError(
            f"The trial record's points must be a list of {FIDUCIAL_COUNT} points, not {count}."
        )
    if count < COARSE_LANDMARKS:
        raise InputError(
            f"The trial record holds {count} touched landmarks; {method.value} needs at least "
            f"{COARSE_LANDMARKS}."
        )
    if method not in TRACED_METHODS and record.trace:
        raise InputError(f"The trial record must hold no trace where the method is {method.value}.")
    if method in TRACED_METHODS and len(record.trace) < MIN_TRACE_POINTS:
        raise InputError(
            f"The trial record's trace has {len(record.trace)} points; {method.value} needs at "
            f"least {MIN_TRACE_POINTS}."
        )


def played_method(value: Any) -> RegistrationMethod:
    """Accept the name of a `PLAYED_METHODS`; the words of a `ValueError` follow "must be"."""
    return RegistrationMethod(_METHOD_NAME(value))


def _text_or_number(value: Any) -> str | float:
    check = json_checks.text() if isinstance(value, str) else json_checks.number(0, 1e9)
    return check(value)


def _optional(check: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return lambda value: None if value is None else check(value)


def check_points(points: tuple[TouchedPoint, ...]) -> None:
    """Raise `InputError` if a label is repeated or the points are not in order of time."""
    seen: set[str] = set()
    for point in points:
        if point.label in seen:
            raise InputError(f"The trial record holds the label {json.dumps(point.label)} twice.")
        seen.add(point.label)
    for earlier, later in itertools.pairwise(points):
        if later.sim_time_s < earlier.sim_time_s:
            raise InputError(
                f"The trial record's points must be in the order of touching: "
                f"{later.label} was touched before {earlier.label}."
            )


_IN_WORLD = json_checks.numbers(3, WORLD_LIMIT_MM, "mm")
_AT_TIME = json_checks.number(0, TIME_LIMIT_S, "s")
_METHOD_NAME = json_checks.one_of(*(method.value for method in PLAYED_METHODS))
_POINT_KEYS = {
    "label": Argument(json_checks.text()),
    "positionMm": Argument(_IN_WORLD),
    "simTime": Argument(_AT_TIME),
    "utc": Argument(utc_time),
}

SHARED_CHECKS = {
    "trialId": Argument(json_checks.trial_id),
    "trainee": Argument(json_checks.text()),
    "task": Argument(json_checks.text()),
    "mode": Argument(json_checks.one_of(*(mode.value for mode in Mode))),
    "scenario": Argument(json_checks.text()),
    "startedUtc": Argument(utc_time),
    "rejectedTouches": Argument(json_checks.whole_number(0, TOUCH_LIMIT)),
    "undoneTouches": Argument(json_checks.whole_number(0, TOUCH_LIMIT)),
    "versions": Argument(
        json_checks.mapping(VERSIONS_LIMIT, "names with their versions as text", json_checks.text())
    ),
    "touchRule": Argument(json_checks.one_of(*(rule.value for rule in TouchRule))),
    "number": Argument(json_checks.whole_number(0, NUMBER_LIMIT), 0),
    "series": Argument(json_checks.text(36, 0), ""),
}
"""Of the keys that the records of finished and of aborted trials share."""

_CHECKS = {
    **SHARED_CHECKS,
    "completedUtc": Argument(utc_time),
    "completionTimeS": Argument(json_checks.number(0, TIME_LIMIT_S, "s")),
    "points": Argument(points_up_to_all),
    "seed": Argument(_optional(json_checks.whole_number(0, 2**63 - 1)), None),
    "motion": Argument(
        json_checks.mapping(
            MOTION_LIMIT, "names with finite numbers", json_checks.number(-1e9, 1e9)
        ),
        {},
    ),
    "display": Argument(
        json_checks.mapping(DISPLAY_LIMIT, "names with texts or finite numbers", _text_or_number),
        {},
    ),
    "procedure": Argument(_optional(ProcedureRecord.from_json), None),
    "method": Argument(played_method, RegistrationMethod.FIDUCIALS),
    "trace": Argument(trace_points, ()),
    "skin": Argument(SkinShift.from_json, UNMOVED),
    "played": Argument(_optional(HowPlayed.from_json), None),
    "journalSha256": Argument(json_checks.text(64, 0), ""),
}
