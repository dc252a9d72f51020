"""What was traced over the skin: values of the trial's state, in m and s."""

from __future__ import annotations

from dataclasses import dataclass, replace

from rastrainer.protocol import MAX_TRACE_POINTS, MIN_TRACE_POINTS
from rastrainer_simulator.vectors import Vector


@dataclass(frozen=True)
class TracedPoint:
    """One point of a trace: where the tip was (World, m) and when.

    `elapsed` is the trial's time in s, pauses excluded.
    """

    position: Vector
    sim_time: float
    elapsed: float


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
