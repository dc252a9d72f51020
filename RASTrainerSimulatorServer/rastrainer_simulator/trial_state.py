"""A trial's touches, trace, registration and procedure; m, rad and s."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum

from rastrainer.procedure.record import UsedRegistration
from rastrainer.protocol import MAX_TRACE_POINTS, MIN_TRACE_POINTS, Phase
from rastrainer_simulator.vectors import Vector, angle, dot, length, reject, subtract, unit


@dataclass(frozen=True)
class TracedPoint:
    """One point of a trace: where it was measured (World, m) and when.

    `elapsed` is the trial's time in s, pauses excluded; `tip` is where the tip was seen, if it was
    elsewhere.
    """

    position: Vector
    sim_time: float
    elapsed: float
    tip: Vector | None = None

    @property
    def seen(self) -> Vector:
        """Where the tip was seen, World, m."""
        return self.tip or self.position


@dataclass(frozen=True)
class TraceState:
    """The points that were traced, stroke by stroke, and whether a stroke is being drawn.

    `strokes` are the numbers of points before each stroke.
    """

    points: tuple[TracedPoint, ...] = ()
    strokes: tuple[int, ...] = ()
    is_on: bool = False

    @property
    def is_enough(self) -> bool:
        """Whether the trace can be registered."""
        return len(self.points) >= MIN_TRACE_POINTS

    @property
    def is_full(self) -> bool:
        """Whether it accepts no further point."""
        return len(self.points) >= MAX_TRACE_POINTS

    def begun(self) -> TraceState:
        return replace(self, strokes=(*self.strokes, len(self.points)), is_on=True)

    def with_point(self, point: TracedPoint) -> TraceState:
        return replace(self, points=(*self.points, point))

    def ended(self) -> TraceState:
        """Return the trace without a stroke being drawn; one without a point is forgotten."""
        is_empty = bool(self.strokes) and self.strokes[-1] == len(self.points)
        strokes = self.strokes[:-1] if is_empty else self.strokes
        return replace(self, strokes=strokes, is_on=False)

    def undone(self) -> TraceState:
        return TraceState(self.points[: self.strokes[-1]], self.strokes[:-1])


@dataclass(frozen=True)
class TouchState:
    """One touched fiducial: where it was measured (World, m) and when.

    `elapsed` is the trial's time in s, pauses excluded.
    """

    label: str
    position: Vector
    sim_time: float
    elapsed: float


@dataclass(frozen=True)
class CheckedPoint:
    """A checkpoint as it was touched: where the tip was (World, m) and when.

    `error` is its distance to the checkpoint by the registration in use, m; `elapsed` the trial's
    time in s, pauses excluded.
    """

    name: str
    position: Vector
    error: float
    sim_time: float
    elapsed: float


@dataclass(frozen=True)
class RegistrationAttempt:
    """One round of touching, registering and checking.

    The registration is None if the trainee touched again before there was one.
    """

    touches: tuple[TouchState, ...]
    registration: UsedRegistration | None
    checkpoints: tuple[CheckedPoint, ...]


class Tool(str, Enum):
    """The robot's tool. All have the pointer's tip and axis; drill and electrode pass through
    the guide and beyond its tip."""

    POINTER = "pointer"
    GUIDE = "guide"
    DRILL = "drill"
    ELECTRODE = "electrode"


EXACT_M, EXACT_RAD = 5e-5, math.radians(0.05)
"""The robot by itself aligns the guide at least this exactly; no hand does."""

TOOL_OF_PHASE: Mapping[Phase, Tool] = {
    Phase.ALIGNING: Tool.GUIDE,
    Phase.DRILLING: Tool.DRILL,
    Phase.INSERTING: Tool.ELECTRODE,
}
"""In all other phases it is the pointer."""


@dataclass(frozen=True)
class PlannedLine:
    """A planned trajectory as the registration in use shows it: entry and target, World, m."""

    name: str
    entry: Vector
    target: Vector

    @property
    def direction(self) -> Vector:
        return unit(subtract(self.target, self.entry))


@dataclass(frozen=True)
class GuideAxis:
    """The guide as it was locked: its tip, World, m, and its axis into the head, a unit vector."""

    tip: Vector
    direction: Vector


@dataclass(frozen=True)
class GuideAlignment:
    """The position of the guide relative to the planned line.

    Attributes:
        entry_distance: perpendicular distance of the planned entry from the guide's axis, m.
        angle: between the guide's axis and the planned line, rad.
        stand_off: distance along the axis from the tip to the planned entry, m; negative once the
            tip is past it.
    """

    entry_distance: float
    angle: float
    stand_off: float

    @property
    def is_exact(self) -> bool:
        """Whether the guide lies as the robot brings it onto a line by itself."""
        return self.entry_distance <= EXACT_M and self.angle <= EXACT_RAD

    @classmethod
    def of(cls, guide: GuideAxis, line: PlannedLine) -> GuideAlignment:
        to_entry = subtract(line.entry, guide.tip)
        return cls(
            length(reject(to_entry, guide.direction)),
            angle(guide.direction, line.direction),
            dot(to_entry, guide.direction),
        )


@dataclass(frozen=True)
class TrajectoryState:
    """The work on one planned trajectory; depths are beyond the guide's tip, m, times in s.

    Attributes:
        line: as the registration in use shows it.
        alignments: how often the guide was locked.
        is_self_aligned: whether the robot brought the guide onto the line, or it was locked as
            the robot would have brought it; what hands changed of it since makes it no less so.
        drill_depth: the deepest that the drill was.
        instrument_depth: where the instrument was released; None before.
    """

    line: PlannedLine
    alignments: int = 0
    guide: GuideAxis | None = None
    is_self_aligned: bool = False
    drill_depth: float = 0.0
    instrument_depth: float | None = None
    times_s: Mapping[Phase, float] = field(default_factory=dict)


@dataclass(frozen=True)
class ProcedureState:
    """The progress of a trial's procedure; the same object until something changes.

    Attributes:
        stage: the phase that it is in, also while the trial is paused; `running` until the
            touches are registered.
        since: the trial's time in s at which the stage began.
        registration: in use; None before.
        checkpoints: touched by it, in their order.
        attempts: at registering, before the present one; after its acceptance with it.
        trajectories: in the order of the plan; () before a registration is in use.
        trajectory: number of the present trajectory, from 0.
        times_s: of `running` and `verifying`, pauses excluded.
        ended_s: the trial's time in s at which the last instrument was released; None before.
    """

    name: str
    stage: Phase = Phase.RUNNING
    since: float = 0.0
    registration: UsedRegistration | None = None
    checkpoints: tuple[CheckedPoint, ...] = ()
    attempts: tuple[RegistrationAttempt, ...] = ()
    trajectories: tuple[TrajectoryState, ...] = ()
    trajectory: int = 0
    times_s: Mapping[Phase, float] = field(default_factory=dict)
    ended_s: float | None = None

    @property
    def tool(self) -> Tool:
        return TOOL_OF_PHASE.get(self.stage, Tool.POINTER)

    @property
    def present(self) -> TrajectoryState | None:
        """The current trajectory; None before the registration is accepted."""
        return self.trajectories[self.trajectory] if self.stage in TOOL_OF_PHASE else None

    def entering(self, stage: Phase, elapsed: float) -> ProcedureState:
        """Return the state in another stage, with the time of the previous stage counted.

        `elapsed` is the trial's time in s.
        """
        passed = elapsed - self.since
        left = replace(self, stage=stage, since=elapsed)
        if self.stage not in TOOL_OF_PHASE:
            return replace(left, times_s=_added(self.times_s, self.stage, passed))
        here = self.trajectories[self.trajectory]
        timed = replace(here, times_s=_added(here.times_s, self.stage, passed))
        return left.with_present(timed)

    def with_present(self, trajectory: TrajectoryState) -> ProcedureState:
        before, after = self.trajectories[: self.trajectory], self.trajectories[self.trajectory :]
        return replace(self, trajectories=(*before, trajectory, *after[1:]))


def _added(times: Mapping[Phase, float], stage: Phase, passed: float) -> Mapping[Phase, float]:
    return {**times, stage: times.get(stage, 0.0) + passed}
