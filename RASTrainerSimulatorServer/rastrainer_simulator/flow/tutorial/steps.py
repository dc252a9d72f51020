"""The steps of the tutorial, each about one control, and how much of a step is done."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum

from rastrainer.journal.entries import GUIDED_TOUCHES
from rastrainer.protocol import Mode
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.input.inputs import ControlName, SourceKind
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
        yaw_deg: where the eyes look, from World's x; None without a headset's controllers.
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


Amount = Callable[[float, TutorialObservation, TutorialObservation, TutorialObservation], float]
"""Returns the amount after an observation; it is given the amount before, and the first, the
previous and the newest observation of the step."""


@dataclass(frozen=True)
class StepRule:
    """What there is to do in a step, and how much of it is done.

    Attributes:
        controls: that do it; its sentence names the first, or the first two as a pair. Where slow
            motion is among them, the tip may go anywhere.
        goal: 1 for a condition.
        shown: key of the text that says how much is done; "" for none.
    """

    controls: tuple[ControlName, ...]
    goal: float
    done: Amount
    shown: str = ""


DONE_MM, DONE_DEG = "tutorial.done mm", "tutorial.done degrees"


def _moved(
    control: ControlName, right: float = 0.0, forward: float = 0.0, up: float = 0.0
) -> StepRule:
    """Measure how far the tip has moved in one direction, mm, since it last moved the other way."""

    def done(
        done: float, _first: object, before: TutorialObservation, now: TutorialObservation
    ) -> float:
        way = now.axes.to_world((right, forward, up))
        return max(0.0, done + MM_PER_M * dot(subtract(now.tip, before.tip), way))

    return StepRule((control,), MOVE_MM, done, DONE_MM)


def _moved_slowly(
    done: float, _first: object, before: TutorialObservation, now: TutorialObservation
) -> float:
    """Return how far the tip has moved while the control for slow motion was held, mm."""
    is_slow = before.is_slow and now.is_slow
    return done + MM_PER_M * distance(before.tip, now.tip) if is_slow else done


def _view_turned(
    done: float, first: TutorialObservation, _before: object, now: TutorialObservation
) -> float:
    """Return by how much the view was turned, to any side, degrees."""
    turn = math.remainder(now.orbit.azimuth_deg - first.orbit.azimuth_deg, 360.0)
    return max(done, math.hypot(turn, now.orbit.elevation_deg - first.orbit.elevation_deg))


def _looked_around(
    done: float, first: TutorialObservation, _before: object, now: TutorialObservation
) -> float:
    """Return by how much the eyes were turned while the sticks were pushed, degrees."""
    if first.yaw_deg is None or now.yaw_deg is None:
        return done
    return max(done, abs(math.remainder(now.yaw_deg - first.yaw_deg, 360.0)))


def _until(condition: Callable[[TutorialObservation], bool], *controls: ControlName) -> StepRule:
    return StepRule(
        controls, 1.0, lambda done, _first, _before, now: 1.0 if condition(now) else done
    )


def _touched(goal: int, *controls: ControlName, shown: str = "") -> StepRule:
    return StepRule(controls, goal, lambda _done, _first, _before, now: now.touched, shown)


_CAREFULLY = (ControlName.FINE, ControlName.BEST_VIEW)
STEPS: Mapping[TutorialStep, StepRule] = {
    TutorialStep.RIGHT: _moved(ControlName.MOVE_RIGHT, right=1.0),
    TutorialStep.LEFT: _moved(ControlName.MOVE_LEFT, right=-1.0),
    TutorialStep.FORWARD: _moved(ControlName.MOVE_FORWARD, forward=1.0),
    TutorialStep.BACK: _moved(ControlName.MOVE_BACK, forward=-1.0),
    TutorialStep.UP: _moved(ControlName.MOVE_UP, up=1.0),
    TutorialStep.DOWN: _moved(ControlName.MOVE_DOWN, up=-1.0),
    TutorialStep.SLOW: StepRule((ControlName.FINE,), SLOW_MM, _moved_slowly, DONE_MM),
    TutorialStep.TURN_VIEW: StepRule(
        (ControlName.VIEW_LEFT, ControlName.VIEW_RIGHT), TURN_DEG, _view_turned, DONE_DEG
    ),
    TutorialStep.LOOK_AROUND: StepRule(
        (ControlName.MOVE_FORWARD,), LOOK_DEG, _looked_around, DONE_DEG
    ),
    TutorialStep.BEST_VIEW: _until(lambda now: now.has_best_view, ControlName.BEST_VIEW),
    TutorialStep.LOWER: _until(
        lambda now: now.touch is TouchStage.ON_SKIN or now.touched > 0, *_CAREFULLY
    ),
    TutorialStep.TOUCH: _touched(1, ControlName.TOUCH, *_CAREFULLY),
    TutorialStep.UNDO: _until(lambda now: now.undone > 0, ControlName.UNDO),
    TutorialStep.PAUSE: _until(lambda now: now.has_paused, ControlName.MENU),
    TutorialStep.GUIDED: _touched(
        GUIDED_TOUCHES,
        *(ControlName.TOUCH, ControlName.UNDO, *_CAREFULLY),
        shown="tutorial.done points",
    ),
    TutorialStep.AGAIN: _touched(1, ControlName.TOUCH, *_CAREFULLY),
}
