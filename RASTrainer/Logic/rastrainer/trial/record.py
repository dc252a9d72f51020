"""The records of finished and aborted trials, as delivered by the simulator and stored."""

from __future__ import annotations

import contextlib
import itertools
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime, timedelta
from typing import Annotated, Any

import numpy as np

from rastrainer import json_checks, protocol
from rastrainer.errors import InputError
from rastrainer.head.trial_head import UNMOVED, SkinShift
from rastrainer.json_records import NOT_IN_JSON
from rastrainer.procedure.record import TIME_LIMIT_S, ProcedureRecord, Seconds, WorldPoint
from rastrainer.trial.how_played import HowPlayed

TOUCH_LIMIT = 1_000_000
VERSIONS_LIMIT = 32
MOTION_LIMIT = 100
DISPLAY_LIMIT = 16

TracePoint = tuple[float, float, float, float]
"""Position of the tool tip in `World`, in mm, and the simulated time, in s."""


def utc_time(value: Any) -> str:
    """Accept an ISO 8601 date and time in UTC, such as `2024-05-17T09:30:00.250Z`."""
    try:
        # `fromisoformat` reads the letter Z only from Python 3.11 on.
        moment = datetime.fromisoformat(value.replace("Z", "+00:00"))
    except (AttributeError, TypeError, ValueError):
        moment = None
    if moment is None or moment.utcoffset() != timedelta(0):
        raise ValueError("an ISO 8601 date and time in UTC, such as 2024-05-17T09:30:00Z")
    return value


def trace_points(value: Any) -> tuple[TracePoint, ...]:
    """Accept a trace: a list of positions in World with their times, which do not fall."""
    if isinstance(value, (list, tuple)) and len(value) <= protocol.MAX_TRACE_POINTS:
        with contextlib.suppress(ValueError, TypeError, LookupError):
            points: list[TracePoint] = []
            for *place, time_s in value:
                x, y, z = _IN_WORLD(place)
                points.append((x, y, z, _AT_TIME(time_s)))
            if all(later[3] >= earlier[3] for earlier, later in itertools.pairwise(points)):
                return tuple(points)
    raise ValueError(
        f"a list of at most {protocol.MAX_TRACE_POINTS} points [x, y, z, simTimeS], mm and s, in "
        "order of time"
    )


_IN_WORLD = json_checks.numbers(3, protocol.WORLD_LIMIT_MM, "mm")
_AT_TIME = json_checks.number(0, TIME_LIMIT_S, "s")


def _text_or_number(value: Any) -> str | float:
    check = json_checks.text(80) if isinstance(value, str) else json_checks.number(0, 1e9)
    return check(value)


Count = Annotated[int, json_checks.whole_number(0, TOUCH_LIMIT)]
PlayedMethod = Annotated[
    protocol.RegistrationMethod,
    json_checks.one_of(*(each.value for each in protocol.PLAYED_METHODS)),
]
Utc = Annotated[str, utc_time]
"""The wall clock may jump, so no duration is taken from it."""


@dataclass(frozen=True)
class TouchedPoint:
    """One fiducial as it was touched: its label, and where the tool tip was in `World`."""

    label: str
    position_mm: WorldPoint
    sim_time_s: Seconds
    utc: Utc


@dataclass(frozen=True, kw_only=True)
class AnyTrial:
    """Fields that the records of finished and of aborted trials share.

    Attributes:
        task: name, such as `task-1` or `trial-run`.
        points: the kept touches, of all fifteen fiducials or of landmarks, in their order; their
            labels differ and their times do not fall.
        rejected_touches: number of touches that were refused (too far off, wrong fiducial).
        versions: name and version of each program and format that made the record.
        method: how the trial is registered, or would have been; a `PLAYED_METHODS`.
        number: of the trial in its simulator's folder; 0 if unknown.
        series: UUID of that numbering.
    """

    trial_id: Annotated[str, json_checks.trial_id]
    trainee: str
    task: str
    mode: Annotated[str, json_checks.one_of(*(mode.value for mode in protocol.Mode))]
    scenario: str
    started_utc: Utc
    points: Annotated[
        tuple[TouchedPoint, ...], json_checks.list_of(0, protocol.FIDUCIAL_COUNT, "points")
    ]
    rejected_touches: Count
    undone_touches: Count
    versions: Annotated[Mapping[str, str], json_checks.object_of(VERSIONS_LIMIT)]
    touch_rule: Annotated[str, json_checks.one_of(*(rule.value for rule in protocol.TouchRule))] = (
        protocol.TouchRule.WITHIN_RADIUS.value
    )
    method: PlayedMethod = protocol.RegistrationMethod.FIDUCIALS
    number: Annotated[int, json_checks.whole_number(0, protocol.NUMBER_LIMIT)] = 0
    series: Annotated[str, json_checks.text(36, 0)] = ""

    def __post_init__(self) -> None:
        labels = [point.label for point in self.points]
        repeated = next((each for each in labels if labels.count(each) > 1), None)
        if repeated is not None:
            raise InputError(f"The trial record holds the label {json.dumps(repeated)} twice.")
        for earlier, later in itertools.pairwise(self.points):
            if later.sim_time_s < earlier.sim_time_s:
                raise InputError(
                    f"The trial record's points must be in the order of touching: "
                    f"{later.label} was touched before {earlier.label}."
                )


@dataclass(frozen=True, kw_only=True)
class TrialRecord(AnyTrial):
    """A finished trial, as it was played; a `TrialAnalysis` has its results.

    Attributes:
        completion_time_s: simulated time from the start to the last kept touch, or the last point
            of the trace, without pauses.
        motion: motion metrics by name (`rastrainer.motion`).
        display: what the trainee looked at: `kind`, `device`, `refreshHz`, `shownFrames` and
            `droppedFrames`, the `guidance` to the next point, and the `ghost` that was shown (a
            `GhostRule`); empty if no view reported it.
        procedure: done after the touches; None in a trial of touches alone. The points belong to
            the accepted registration.
        trace: the points that were traced over the skin, in order of time; empty if the method
            has no trace.
        skin: its shift, without the seed: that is revealed with the truth.
        played: who moved the arm, and more; None of a trial that no simulator recorded.
        journal_sha256: hash of the journal's line of this record, which stands for all lines up to
            it; "" in that line itself.
    """

    completed_utc: Utc
    completion_time_s: Seconds
    seed: Annotated[int | None, json_checks.whole_number(0, 2**63 - 1)] = None
    motion: Annotated[
        Mapping[str, Annotated[float, json_checks.number(-1e9, 1e9)]],
        json_checks.object_of(MOTION_LIMIT),
    ] = field(default_factory=dict)
    display: Annotated[
        Mapping[str, Annotated[str | float, _text_or_number]], json_checks.object_of(DISPLAY_LIMIT)
    ] = field(default_factory=dict)
    procedure: ProcedureRecord | None = None
    trace: Annotated[tuple[TracePoint, ...], trace_points] = ()
    skin: SkinShift = UNMOVED
    played: HowPlayed | None = None
    journal_sha256: Annotated[str, json_checks.text(64, 0)] = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.skin.seed:
            object.__setattr__(self, "skin", replace(self.skin, seed=0))
        method, count = self.method, len(self.points)
        if method is protocol.RegistrationMethod.FIDUCIALS and count != protocol.FIDUCIAL_COUNT:
            raise InputError(
                f"The trial record's points must be a list of {protocol.FIDUCIAL_COUNT} points, "
                f"not {count}."
            )
        if count < protocol.COARSE_LANDMARKS:
            raise InputError(
                f"The trial record holds {count} touched landmarks; {method.value} needs at least "
                f"{protocol.COARSE_LANDMARKS}."
            )
        if method not in protocol.TRACED_METHODS and self.trace:
            raise InputError(
                f"The trial record must hold no trace where the method is {method.value}."
            )
        if method in protocol.TRACED_METHODS and len(self.trace) < protocol.MIN_TRACE_POINTS:
            raise InputError(
                f"The trial record's trace has {len(self.trace)} points; {method.value} needs at "
                f"least {protocol.MIN_TRACE_POINTS}."
            )

    @property
    def labels(self) -> tuple[str, ...]:
        return tuple(point.label for point in self.points)

    @property
    def positions_mm(self) -> np.ndarray:
        return np.array([point.position_mm for point in self.points], dtype=float)

    @property
    def trace_mm(self) -> np.ndarray:
        return np.array(self.trace, dtype=float).reshape(-1, 4)[:, :3]


@dataclass(frozen=True, kw_only=True)
class AbortedTrial(AnyTrial):
    """A trial that was started and never registered.

    If it has touches, it counts as an attempt: aborting bad trials helps no one to pass.

    Attributes:
        elapsed_s: simulated time from the start to the end, or to the last touch where all were
            made; without pauses.
        phase: in which it was aborted: `running`, `paused`, or `complete` after all touches.
        reason: an `AbortReason`, or a later version's reason.
        step: of a study that was repeated because of it, for the `repeat_reason`.
    """

    aborted_utc: Utc
    elapsed_s: Seconds
    phase: Annotated[str, json_checks.one_of(*(phase.value for phase in protocol.OPEN_PHASES))]
    reason: str
    traced: Annotated[int, json_checks.whole_number(0, protocol.MAX_TRACE_POINTS)] = 0
    step: str = field(default="", metadata=NOT_IN_JSON)
    repeat_reason: str = field(default="", metadata=NOT_IN_JSON)

    @property
    def done(self) -> str:
        """How far the trainee came, such as "3 of 15 points touched"."""
        touched = len(self.points)
        if self.method is protocol.RegistrationMethod.FIDUCIALS:
            return f"{touched} of {protocol.FIDUCIAL_COUNT} points touched"
        landmarks = f"{touched} landmark{'' if touched == 1 else 's'} touched"
        if self.method not in protocol.TRACED_METHODS:
            return landmarks
        return f"{landmarks} and {self.traced} points traced"

    @property
    def is_after_all_touches(self) -> bool:
        """Whether all fiducials were touched and only Register was missing."""
        return self.phase == protocol.Phase.COMPLETE.value

    @property
    def is_kept(self) -> bool:
        """Whether a study stores it: it has a touch, even a refused one, or took some time."""
        touches = len(self.points) + self.rejected_touches + self.undone_touches
        return touches > 0 or self.elapsed_s > protocol.MIN_ABORTED_S

    @property
    def counts_as_failed(self) -> bool:
        """Whether it counts as not passed: a scored task with a kept or undone touch."""
        return self.task != protocol.TRIAL_RUN and len(self.points) + self.undone_touches > 0
