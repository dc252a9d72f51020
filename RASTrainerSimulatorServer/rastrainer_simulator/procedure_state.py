"""How far a trial's procedure is: its registration, its checkpoints and its planned lines."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum

from rastrainer.protocol import Phase
from rastrainer_simulator.registration_state import (
    CheckedPoint,
    FinalRegistration,
    RegistrationAttempt,
)
from rastrainer_simulator.vectors import Vector, angle, dot, length, reject, subtract, unit


class Tool(str, Enum):
    """What the robot holds. All have the pointer's tip and axis; drill and electrode pass through
    the guide and beyond its tip."""

    POINTER = "pointer"
    GUIDE = "guide"
    DRILL = "drill"
    ELECTRODE = "electrode"


EXACT_M, EXACT_RAD = 5e-5, math.radians(0.05)
"""The robot aligns the guide at least so exactly by itself; no hand does."""

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
        """The unit vector from entry to target."""
        return unit(subtract(self.target, self.entry))


@dataclass(frozen=True)
class GuideAxis:
    """The guide as it was locked: its tip, World, m, and its axis into the head, a unit vector."""

    tip: Vector
    direction: Vector


@dataclass(frozen=True)
class GuideAlignment:
    """How the guide lies to the planned line.

    Attributes:
        entry_distance: perpendicular distance of the planned entry from the guide's axis, m.
        angle: between the guide's axis and the planned line, rad.
        stand_off: distance along the axis from the tip to beside the planned entry, m; below 0
            where the tip is past it.
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
        """Return how a guide lies to a planned line."""
        to_entry = subtract(line.entry, guide.tip)
        return cls(
            length(reject(to_entry, guide.direction)),
            angle(guide.direction, line.direction),
            dot(to_entry, guide.direction),
        )


@dataclass(frozen=True)
class TrajectoryState:
    """What was done for one planned trajectory; depths are beyond the guide's tip, m, times in s.

    Attributes:
        line: as the registration in use shows it.
        alignments: how often the guide was locked.
        guide: as it was locked last; None before.
        is_self_aligned: whether it was locked as the robot aligns it by itself.
        drill_depth: the deepest that the drill was.
        instrument_depth: where the instrument was released; None before.
        times_s: by phase, pauses excluded.
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
    """How far the procedure of a trial is; the same object until something changes.

    Attributes:
        name: of the procedure.
        stage: the phase that it is in, also while the trial is paused; `running` until the
            touches are registered.
        since: the trial's time in s at which the stage began.
        registration: in use; None before.
        checkpoints: touched by it, in their order.
        attempts: at registering, before the present one; after its acceptance with it.
        trajectories: in the order of the plan; () before a registration is in use.
        trajectory: number of the one that is at hand, from 0.
        times_s: of `running` and `verifying`, pauses excluded.
        ended_s: the trial's time in s at which the last instrument was released; None before.
    """

    name: str
    stage: Phase = Phase.RUNNING
    since: float = 0.0
    registration: FinalRegistration | None = None
    checkpoints: tuple[CheckedPoint, ...] = ()
    attempts: tuple[RegistrationAttempt, ...] = ()
    trajectories: tuple[TrajectoryState, ...] = ()
    trajectory: int = 0
    times_s: Mapping[Phase, float] = field(default_factory=dict)
    ended_s: float | None = None

    @property
    def tool(self) -> Tool:
        """What the robot holds."""
        return TOOL_OF_PHASE.get(self.stage, Tool.POINTER)

    @property
    def present(self) -> TrajectoryState | None:
        """The trajectory at hand; None before the registration is accepted."""
        return self.trajectories[self.trajectory] if self.stage in TOOL_OF_PHASE else None

    def entering(self, stage: Phase, elapsed: float) -> ProcedureState:
        """Return the state in another stage, the time of the one before counted.

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
        """Return the state with the trajectory at hand replaced."""
        before, after = self.trajectories[: self.trajectory], self.trajectories[self.trajectory :]
        return replace(self, trajectories=(*before, trajectory, *after[1:]))


def _added(times: Mapping[Phase, float], stage: Phase, passed: float) -> Mapping[Phase, float]:
    return {**times, stage: times.get(stage, 0.0) + passed}
