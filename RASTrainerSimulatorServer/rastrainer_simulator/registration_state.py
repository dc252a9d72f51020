"""What was touched and traced, and how it was registered: values of the trial's state, m and s."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from rastrainer.protocol import MAX_TRACE_POINTS, MIN_TRACE_POINTS
from rastrainer_simulator.vectors import Vector


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
    """The points that were traced, stroke by stroke.

    Attributes:
        points: in the order of tracing.
        strokes: how many points there were before each stroke.
        is_on: whether a stroke is being drawn.
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
        """Whether it takes no further point."""
        return len(self.points) >= MAX_TRACE_POINTS

    def begun(self) -> TraceState:
        """Return the trace with a new stroke."""
        return replace(self, strokes=(*self.strokes, len(self.points)), is_on=True)

    def with_point(self, point: TracedPoint) -> TraceState:
        """Return the trace with one more point."""
        return replace(self, points=(*self.points, point))

    def ended(self) -> TraceState:
        """Return the trace without a stroke being drawn; one without a point is forgotten."""
        is_empty = bool(self.strokes) and self.strokes[-1] == len(self.points)
        strokes = self.strokes[:-1] if is_empty else self.strokes
        return replace(self, strokes=strokes, is_on=False)

    def cut(self, count: int) -> TraceState:
        """Return the trace with the first `count` points."""
        strokes = tuple(before for before in self.strokes if before < count)
        return TraceState(self.points[:count], strokes, self.is_on and count == len(self.points))

    def undone(self) -> TraceState:
        """Return the trace without its last stroke."""
        return TraceState(self.points[: self.strokes[-1]], self.strokes[:-1])


SAME = 1e-9
"""Registrations are the same up to this part of a number, and up to as many mm."""


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
class FinalRegistration:
    """A registration by its numbers: one in use, or the one that was submitted for a trial (mm).

    `matrix` is WorldToHead, 16 floats row by row, mm.
    """

    matrix: tuple[float, ...]
    fre_mm: float
    expected_tre_mm: float

    @classmethod
    def from_arguments(cls, arguments: Mapping[str, Any]) -> FinalRegistration:
        """Return what the arguments of UseRegistration or SubmitRegistration hold."""
        return cls(tuple(arguments["matrix"]), arguments["freMm"], arguments["expectedTreMm"])

    def agrees_with(self, other: FinalRegistration) -> bool:
        """Return whether both are the outcome of one computation.

        Slicer's numpy and the simulator's may round the last digits otherwise; who knows the truth
        gains nothing from so little.
        """
        pairs = zip(self._numbers(), other._numbers(), strict=True)
        return all(math.isclose(a, b, rel_tol=SAME, abs_tol=SAME) for a, b in pairs)

    def _numbers(self) -> tuple[float, ...]:
        return (*self.matrix, self.fre_mm, self.expected_tre_mm)


@dataclass(frozen=True)
class CheckedPoint:
    """A checkpoint as it was touched.

    Attributes:
        name: of the checkpoint.
        position: of the tip, World, m.
        error: its distance to the checkpoint by the registration in use, m.
        sim_time: s.
        elapsed: the trial's time in s, pauses excluded.
    """

    name: str
    position: Vector
    error: float
    sim_time: float
    elapsed: float


@dataclass(frozen=True)
class RegistrationAttempt:
    """One round of touching, registering and checking.

    Attributes:
        touches: that were registered.
        registration: that was used; None where the trainee touched again before there was one.
        checkpoints: that were touched by it.
    """

    touches: tuple[TouchState, ...]
    registration: FinalRegistration | None
    checkpoints: tuple[CheckedPoint, ...]
