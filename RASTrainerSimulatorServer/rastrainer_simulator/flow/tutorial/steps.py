"""The steps of the tutorial, each about one control, and how much of a step is done."""

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
    """Return the steps for a device in a display mode, in order.

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


@dataclass(frozen=True)
class StepMeasure:
    """How much there is to do in a step, and how much of it is done.

    Attributes:
        goal: 1 for a condition.
        done: returns the amount after an observation; it is given the amount before, and the first,
            the previous and the newest observation of the step.
    """

    goal: float
    done: Callable[[float, TutorialObservation, TutorialObservation, TutorialObservation], float]


def _moved(right: float = 0.0, forward: float = 0.0, up: float = 0.0) -> StepMeasure:
    """Measure how far the tip has moved in one direction, mm, since it last moved the other way."""

    def along(before: TutorialObservation, now: TutorialObservation) -> float:
        way = now.axes.to_world((right, forward, up))
        return MM_PER_M * dot(subtract(now.tip, before.tip), way)

    return StepMeasure(
        MOVE_MM, lambda done, _first, before, now: max(0.0, done + along(before, now))
    )


def _moved_slowly(
    done: float, _first: TutorialObservation, before: TutorialObservation, now: TutorialObservation
) -> float:
    """Return how far the tip has moved while the control for slow motion was held, mm."""
    is_slow = before.is_slow and now.is_slow
    return done + MM_PER_M * distance(before.tip, now.tip) if is_slow else done


def _view_turned(
    done: float, first: TutorialObservation, _before: TutorialObservation, now: TutorialObservation
) -> float:
    """Return by how much the view was turned, to any side, degrees."""
    turn = math.remainder(now.orbit.azimuth_deg - first.orbit.azimuth_deg, 360.0)
    return max(done, math.hypot(turn, now.orbit.elevation_deg - first.orbit.elevation_deg))


def _looked_around(
    done: float, first: TutorialObservation, _before: TutorialObservation, now: TutorialObservation
) -> float:
    """Return by how much the eyes were turned while the sticks were pushed, degrees."""
    if first.yaw_deg is None or now.yaw_deg is None:
        return done
    return max(done, abs(math.remainder(now.yaw_deg - first.yaw_deg, 360.0)))


def _until(condition: Callable[[TutorialObservation], bool]) -> StepMeasure:
    return StepMeasure(1.0, lambda done, _first, _before, now: 1.0 if condition(now) else done)


def _touched(goal: int) -> StepMeasure:
    return StepMeasure(goal, lambda _done, _first, _before, now: now.touched)


MEASURES: Mapping[TutorialStep, StepMeasure] = {
    TutorialStep.RIGHT: _moved(right=1.0),
    TutorialStep.LEFT: _moved(right=-1.0),
    TutorialStep.FORWARD: _moved(forward=1.0),
    TutorialStep.BACK: _moved(forward=-1.0),
    TutorialStep.UP: _moved(up=1.0),
    TutorialStep.DOWN: _moved(up=-1.0),
    TutorialStep.SLOW: StepMeasure(SLOW_MM, _moved_slowly),
    TutorialStep.TURN_VIEW: StepMeasure(TURN_DEG, _view_turned),
    TutorialStep.LOOK_AROUND: StepMeasure(LOOK_DEG, _looked_around),
    TutorialStep.BEST_VIEW: _until(lambda now: now.has_best_view),
    TutorialStep.LOWER: _until(lambda now: now.touch is TouchStage.ON_SKIN or now.touched > 0),
    TutorialStep.TOUCH: _touched(1),
    TutorialStep.UNDO: _until(lambda now: now.undone > 0),
    TutorialStep.PAUSE: _until(lambda now: now.has_paused),
    TutorialStep.GUIDED: _touched(GUIDED_TOUCHES),
    TutorialStep.AGAIN: _touched(1),
}
