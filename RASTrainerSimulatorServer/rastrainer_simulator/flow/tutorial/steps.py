"""The steps of the tutorial: one control each, and what has to happen for a step to be done."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum

from rastrainer.protocol import Mode
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.input.inputs import SourceKind
from rastrainer_simulator.record.trial_context import GUIDED_TOUCHES
from rastrainer_simulator.state import TouchStage
from rastrainer_simulator.teleoperation.steering import Axes
from rastrainer_simulator.vectors import Vector, distance, dot, subtract
from rastrainer_simulator.viewpoint.view_control import FRONT, Orbit

MOVE_MM = 30.0
SLOW_MM = 10.0
TURN_DEG = 20.0
LOOK_DEG = 15.0


class TutorialStep(str, Enum):
    """A step; the name is also the key of its sentence."""

    RIGHT = "right"
    LEFT = "left"
    FORWARD = "forward"
    BACK = "back"
    UP = "up"
    DOWN = "down"
    SLOW = "slow"
    TURN_VIEW = "turn view"
    LOOK_AROUND = "look around"
    BEST_VIEW = "best view"
    LOWER = "lower"
    TOUCH = "touch"
    UNDO = "undo"
    PAUSE = "pause"
    GUIDED = "guided"
    AGAIN = "again"


_OF_VIEW = (TutorialStep.TURN_VIEW, TutorialStep.LOOK_AROUND, TutorialStep.BEST_VIEW)
WITH_POINTS = (
    TutorialStep.BEST_VIEW,
    TutorialStep.LOWER,
    TutorialStep.TOUCH,
    TutorialStep.UNDO,
    TutorialStep.PAUSE,
    TutorialStep.GUIDED,
)
"""Steps in which the next point is marked."""
OF_PRACTICE = (TutorialStep.AGAIN,)
"""The only step where one point of a trial is practiced."""


def steps_for(device: SourceKind, mode: str) -> tuple[TutorialStep, ...]:
    """Return the steps for what is held, in the display mode of that name, in order.

    In a headset the trainee looks around by turning the head, and only the controllers' sticks
    follow the eyes.
    """
    view: tuple[TutorialStep, ...] = (TutorialStep.TURN_VIEW, TutorialStep.BEST_VIEW)
    if mode == Mode.HMD.value:
        view = (TutorialStep.LOOK_AROUND,) if device is SourceKind.XR else ()
    left_out = {*_OF_VIEW, *OF_PRACTICE}.difference(view)
    return tuple(step for step in TutorialStep if step not in left_out)


@dataclass(frozen=True)
class TutorialObservation:
    """An observation of what the trainee has done with the simulator.

    Attributes:
        tip: position of the tool's tip, World, m.
        axes: right, forward and up as the sticks mean them.
        is_slow: whether the control for slow motion is held.
        orbit: how the view is turned.
        yaw_deg: where the eyes look, from World's x; None without a headset's controllers.
        has_best_view: whether the view has gone to the best view of the next point.
        touch: how the next touch is going.
        touched: number of kept touches.
        undone: number of touches that were taken back.
        has_paused: whether the menu was opened and closed again in this step.
    """

    tip: Vector
    axes: Axes
    is_slow: bool = False
    orbit: Orbit = FRONT
    yaw_deg: float | None = None
    has_best_view: bool = False
    touch: TouchStage = TouchStage.FAR
    touched: int = 0
    undone: int = 0
    has_paused: bool = False


class StepMeasure:
    """How much of a step is done.

    Attributes:
        goal: how much is to be done; 1 where it is done or not.
        done: how much is.
    """

    def __init__(self, goal: float = 1.0) -> None:
        self.goal = goal
        self.done = 0.0

    @property
    def is_complete(self) -> bool:
        return self.done >= self.goal

    def take(self, before: TutorialObservation, now: TutorialObservation) -> None:
        """Process what has happened between two observations."""
        raise NotImplementedError


class TipMoved(StepMeasure):
    """Distance that the tip has moved in one direction, mm, since it last moved the other way."""

    def __init__(self, right: float = 0.0, forward: float = 0.0, up: float = 0.0) -> None:
        super().__init__(MOVE_MM)
        self._way = right, forward, up

    def take(self, before: TutorialObservation, now: TutorialObservation) -> None:
        """Add the distance between two observations, in the present directions of the sticks."""
        moved = subtract(now.tip, before.tip)
        self.done = max(0.0, self.done + MM_PER_M * dot(moved, now.axes.to_world(self._way)))


class TipMovedSlowly(StepMeasure):
    """Distance that the tip has moved while the control for slow motion was held, mm."""

    def __init__(self) -> None:
        super().__init__(SLOW_MM)

    def take(self, before: TutorialObservation, now: TutorialObservation) -> None:
        """Add the distance between two observations."""
        if before.is_slow and now.is_slow:
            self.done += MM_PER_M * distance(before.tip, now.tip)


class ViewTurned(StepMeasure):
    """Angle by which the view was turned, to any side, degrees."""

    def __init__(self) -> None:
        super().__init__(TURN_DEG)
        self._start: Orbit | None = None

    def take(self, before: TutorialObservation, now: TutorialObservation) -> None:
        """Compare the view with that at the beginning."""
        self._start = self._start or before.orbit
        turn = math.remainder(now.orbit.azimuth_deg - self._start.azimuth_deg, 360.0)
        rise = now.orbit.elevation_deg - self._start.elevation_deg
        self.done = max(self.done, math.hypot(turn, rise))


class LookedAround(StepMeasure):
    """Angle by which the eyes were turned while the sticks were pushed, degrees."""

    def __init__(self) -> None:
        super().__init__(LOOK_DEG)
        self._start: float | None = None

    def take(self, before: TutorialObservation, now: TutorialObservation) -> None:
        """Compare where the eyes look with that at the beginning."""
        if self._start is None:
            self._start = before.yaw_deg
        if self._start is not None and now.yaw_deg is not None:
            turn = math.remainder(now.yaw_deg - self._start, 360.0)
            self.done = max(self.done, abs(turn))


class BecameTrue(StepMeasure):
    """Whether a condition has become true."""

    def __init__(self, condition: Callable[[TutorialObservation], bool]) -> None:
        super().__init__()
        self._condition = condition

    def take(self, before: TutorialObservation, now: TutorialObservation) -> None:  # noqa: ARG002
        """Check the latest observation."""
        if self._condition(now):
            self.done = self.goal


class PointsTouched(StepMeasure):
    """Number of touched points."""

    def __init__(self, goal: int) -> None:
        super().__init__(goal)

    def take(self, before: TutorialObservation, now: TutorialObservation) -> None:  # noqa: ARG002
        """Count them."""
        self.done = now.touched


def _is_lowered(now: TutorialObservation) -> bool:
    return now.touch is TouchStage.ON_SKIN or now.touched > 0


MEASURES: Mapping[TutorialStep, Callable[[], StepMeasure]] = {
    TutorialStep.RIGHT: lambda: TipMoved(right=1.0),
    TutorialStep.LEFT: lambda: TipMoved(right=-1.0),
    TutorialStep.FORWARD: lambda: TipMoved(forward=1.0),
    TutorialStep.BACK: lambda: TipMoved(forward=-1.0),
    TutorialStep.UP: lambda: TipMoved(up=1.0),
    TutorialStep.DOWN: lambda: TipMoved(up=-1.0),
    TutorialStep.SLOW: TipMovedSlowly,
    TutorialStep.TURN_VIEW: ViewTurned,
    TutorialStep.LOOK_AROUND: LookedAround,
    TutorialStep.BEST_VIEW: lambda: BecameTrue(lambda now: now.has_best_view),
    TutorialStep.LOWER: lambda: BecameTrue(_is_lowered),
    TutorialStep.TOUCH: lambda: PointsTouched(1),
    TutorialStep.UNDO: lambda: BecameTrue(lambda now: now.undone > 0),
    TutorialStep.PAUSE: lambda: BecameTrue(lambda now: now.has_paused),
    TutorialStep.GUIDED: lambda: PointsTouched(GUIDED_TOUCHES),
    TutorialStep.AGAIN: lambda: PointsTouched(1),
}
"""For each step its measure, newly made when the step begins."""
