"""One trainee's tutorial: its steps, how much of a step is done, and the outcome.

Its touches go by the rules of a trial, but are recorded nowhere.
"""

from __future__ import annotations

import math
import uuid
from dataclasses import dataclass, replace
from enum import Enum

from rastrainer import transforms
from rastrainer.commands import CommandName
from rastrainer.head.trial_head import Perturbation
from rastrainer.journal.entries import GUIDED_TOUCHES
from rastrainer.protocol import TRIAL_RUN, Mode
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.input.inputs import ControlName, SourceKind
from rastrainer_simulator.record.trial_context import TutorialOutcome
from rastrainer_simulator.state import OperatorCommand, SimulationState, TouchStage
from rastrainer_simulator.teleoperation.steering import Axes
from rastrainer_simulator.training.rules import TouchMoment, touch_stage
from rastrainer_simulator.training.training import Training, TrainingReply
from rastrainer_simulator.vectors import (
    ZERO,
    Vector,
    distance,
    dot,
    in_meters,
    in_millimeters,
    subtract,
)
from rastrainer_simulator.viewpoint.view_control import FRONT, Orbit

MOVE_MM = 30.0
SLOW_MM = 10.0
TURN_DEG = 20.0
LOOK_DEG = 15.0


DONE_MM, DONE_DEG = "tutorial.done mm", "tutorial.done degrees"
_CAREFULLY = (ControlName.FINE, ControlName.BEST_VIEW)
_TURNING = (ControlName.VIEW_LEFT, ControlName.VIEW_RIGHT)
_TOUCHING = (ControlName.TOUCH, *_CAREFULLY)
_REPEATING = (ControlName.TOUCH, ControlName.UNDO, *_CAREFULLY)


class TutorialStep(str, Enum):
    """A step; the name is also the key of its sentence.

    It has the controls that do it, how much there is to do, and the key of what says how far it is.
    Its sentence names the first control, or the first two as a pair. Where slow motion is among
    them, the tip may go anywhere. `way` is right, forward and up of a step that moves the tip in
    one direction.
    """

    controls: tuple[ControlName, ...]
    goal: float
    shown: str
    way: Vector | None

    RIGHT = "right", (ControlName.MOVE_RIGHT,), MOVE_MM, DONE_MM, (1.0, 0.0, 0.0)
    LEFT = "left", (ControlName.MOVE_LEFT,), MOVE_MM, DONE_MM, (-1.0, 0.0, 0.0)
    FORWARD = "forward", (ControlName.MOVE_FORWARD,), MOVE_MM, DONE_MM, (0.0, 1.0, 0.0)
    BACK = "back", (ControlName.MOVE_BACK,), MOVE_MM, DONE_MM, (0.0, -1.0, 0.0)
    UP = "up", (ControlName.MOVE_UP,), MOVE_MM, DONE_MM, (0.0, 0.0, 1.0)
    DOWN = "down", (ControlName.MOVE_DOWN,), MOVE_MM, DONE_MM, (0.0, 0.0, -1.0)
    SLOW = "slow", (ControlName.FINE,), SLOW_MM, DONE_MM
    TURN_VIEW = "turn view", _TURNING, TURN_DEG, DONE_DEG
    LOOK_AROUND = "look around", (ControlName.MOVE_FORWARD,), LOOK_DEG, DONE_DEG
    BEST_VIEW = "best view", (ControlName.BEST_VIEW,)
    LOWER = "lower", _CAREFULLY
    TOUCH = "touch", _TOUCHING
    UNDO = "undo", (ControlName.UNDO,)
    PAUSE = "pause", (ControlName.MENU,)
    GUIDED = "guided", _REPEATING, GUIDED_TOUCHES, "tutorial.done points"
    AGAIN = "again", _TOUCHING

    def __new__(
        cls,
        value: str,
        controls: tuple[ControlName, ...],
        goal: float = 1.0,
        shown: str = "",
        way: Vector | None = None,
    ) -> TutorialStep:
        step = str.__new__(cls, value)
        step._value_, step.controls, step.goal = value, controls, goal
        step.shown, step.way = shown, way
        return step


_OF_VIEW = (TutorialStep.TURN_VIEW, TutorialStep.LOOK_AROUND, TutorialStep.BEST_VIEW)
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


def amount_done(
    step: TutorialStep,
    done: float,
    first: TutorialObservation,
    before: TutorialObservation,
    now: TutorialObservation,
) -> float:
    """Return how much of a step is done, by its first, the previous and the newest observation."""
    moved_mm = MM_PER_M * distance(before.tip, now.tip)
    turned_deg = math.remainder(now.orbit.azimuth_deg - first.orbit.azimuth_deg, 360.0)
    raised_deg = now.orbit.elevation_deg - first.orbit.elevation_deg
    match step:
        case TutorialStep.SLOW:
            return done + moved_mm if before.is_slow and now.is_slow else done
        case TutorialStep.TURN_VIEW:
            return max(done, math.hypot(turned_deg, raised_deg))
        case TutorialStep.LOOK_AROUND:
            if first.yaw_deg is None or now.yaw_deg is None:
                return done
            return max(done, abs(math.remainder(now.yaw_deg - first.yaw_deg, 360.0)))
        case TutorialStep.BEST_VIEW:
            return float(now.has_best_view)
        case TutorialStep.LOWER:
            return float(now.touch is TouchStage.ON_SKIN or now.touched > 0)
        case TutorialStep.UNDO:
            return float(now.undone > 0)
        case TutorialStep.PAUSE:
            return float(now.has_paused)
        case TutorialStep.TOUCH | TutorialStep.GUIDED | TutorialStep.AGAIN:
            return now.touched
    assert step.way is not None, "all other steps move the tip"
    # Since the tip last moved the other way.
    moved = subtract(now.tip, before.tip)
    return max(0.0, done + MM_PER_M * dot(moved, now.axes.to_world(step.way)))


_NOT_MOVED = Perturbation(0.0, 0.0, 0.0)
PRAISE_S = 0.8
"""How long a completed step is praised before the next one begins."""
CENTERED_M = 0.003
"""The longest distance of a touch to its point: trials allow more, but the center is aimed at."""


class TouchPractice:
    """Some points of a task, touched while no trial is open.

    It uses the state machine of a trial, with its rules, but the simulation, its clients and
    the journals know nothing of it: only what the views show is changed (`shown`).
    """

    def __init__(
        self,
        setup: SimulationSetup,
        state: SimulationState,
        arguments: dict[str, str],
        points: slice,
        rest: Vector | None = None,
        task: str = TRIAL_RUN,
    ) -> None:
        """Begin by checked arguments of StartTask, with `trialId`; the head stays where it is.

        `rest` is where the tip may still be on the skin from a touch before, World, m.
        """
        self._rest = rest
        self._settings = replace(setup.settings.training, acceptance_radius=CENTERED_M)
        self._of_trials = setup.settings.training
        pose = transforms.in_millimeters(state.head_to_world)
        tasks = setup.scenario.tasks
        whole = next((each for each in tasks if each.name == task), tasks[0])
        short = replace(whole, labels=whole.labels[points], fiducials=whole.fiducials[points])
        scenario = replace(
            setup.scenario, tasks=(short,), head_to_world=pose, perturbation=_NOT_MOVED
        )
        self.training = Training(scenario, 0, self._settings)
        start = {**arguments, "task": short.name}
        self.training.handle(OperatorCommand(CommandName.START_TASK, start), _moment(state))
        self.has_points = False

    def handle(self, command: str, state: SimulationState) -> TrainingReply:
        return self.training.handle(OperatorCommand(command), _moment(state))

    def errors_mm(self) -> tuple[float, ...]:
        touches = self.training.state.touches
        places = ((t.label, in_millimeters(t.position)) for t in touches)
        return tuple(self.training.truth.touch_errors_mm(places).values())

    def shown(self, state: SimulationState) -> SimulationState:
        """Return a state of the simulation as the views show it; called in any thread."""
        training = self.training.state
        if not self.has_points:
            training = replace(training, next_point=None)
        goal = self.training.goal_of(training)
        # The state says that the arm is stopped, but not by which obstacle.
        obstacle = state.touch.value if state.touch is TouchStage.ARM else ""
        stage = touch_stage(
            _moment(state), state.proximity, obstacle, training, goal, self._of_trials
        )
        is_on_point = stage in (TouchStage.ON_SKIN, TouchStage.PRESSED)
        is_beside = is_on_point and distance(state.tip, goal or ZERO) > CENTERED_M
        radius = self._of_trials.acceptance_radius
        is_at_rest = self._rest is not None and distance(state.tip, self._rest) <= radius
        if is_beside or (stage is TouchStage.ELSEWHERE and is_at_rest):
            stage = TouchStage.NEAR
        return replace(state, training=training, touch=stage)

    def off_center_mm(self, state: SimulationState) -> float | None:
        """Return how far from a point's center the tip is on the skin, mm; None elsewhere."""
        goal, tip = self.training.goal_of(self.training.state), state.tip
        if goal is None or state.tip_clearance > self._settings.skin_tolerance:
            return None
        off = distance(tip, goal)
        is_beside = CENTERED_M < off <= self._of_trials.acceptance_radius
        return MM_PER_M * off if is_beside else None


def _moment(state: SimulationState) -> TouchMoment:
    return TouchMoment(state.sim_time, state.tip, state.tip_clearance, state.depth)


class Tutorial:
    """Leads through the steps; a step is done when the arm, the view or a touch has really changed.

    `practiced` is the point of a trial that is practiced instead; "" in the tutorial itself.
    `praised` is the step that was just done, for a moment.
    """

    def __init__(
        self,
        setup: SimulationSetup,
        state: SimulationState,
        arguments: dict[str, str],
        practiced: str = "",
    ) -> None:
        """Begin, by checked arguments of StartTask; `practiced` is a point of its task."""
        self.trainee, self.mode = arguments["trainee"], arguments["mode"]
        self.setup = setup
        trial = {**arguments, "trialId": str(uuid.uuid4())}
        self._first = TouchPractice(setup, state, trial, slice(1))
        rest = self._first.training.goal_of(self._first.training.state)
        guided, task = slice(1, 1 + GUIDED_TOUCHES), TRIAL_RUN
        self.practiced = practiced
        if practiced:
            task, rest = arguments["task"], None
            place = setup.scenario.task(task).labels.index(practiced)
            guided = slice(place, place + 1)
        self._guided = TouchPractice(setup, state, trial, guided, rest, task)
        self._guided.has_points = True
        truths = self._first.training.truth, self._guided.training.truth
        self.points = {
            label: in_meters(truth.in_world(point))
            for truth in truths
            for label, point in truth.fiducials_ras.items()
        }
        self.praised: TutorialStep | None = None
        self._praise_s = 0.0
        self.use(SourceKind.KEYBOARD)
        self._done: list[TutorialStep] = []
        self._amount = 0.0
        self._first_seen: TutorialObservation | None = None
        self._before: TutorialObservation | None = None
        self._seconds: dict[str, float] = {}
        self._first_error_mm = 0.0

    @property
    def practice(self) -> TouchPractice:
        """The present practice: first a single point, then the guided points."""
        return self._guided if self.has_learned_view else self._first

    @property
    def step(self) -> TutorialStep | None:
        return next((step for step in self.steps if step not in self._done), None)

    @property
    def place(self) -> tuple[int, int]:
        """The number of the step, from 1, and how many there are."""
        done = sum(step in self._done for step in self.steps)
        return min(done + 1, len(self.steps)), len(self.steps)

    @property
    def amount(self) -> tuple[float, float]:
        if self.step is None or self._first_seen is None:
            return 0.0, 1.0
        return min(self._amount, self.step.goal), self.step.goal

    @property
    def has_learned_view(self) -> bool:
        return self.step in (None, TutorialStep.GUIDED, *OF_PRACTICE)

    @property
    def may_touch(self) -> bool:
        return self.step is TutorialStep.LOWER or self.asks_for(ControlName.TOUCH)

    def asks_for(self, control: ControlName) -> bool:
        return self.step is not None and control in self.step.controls

    def use(self, device: SourceKind) -> None:
        self.steps = OF_PRACTICE if self.practiced else steps_for(device, self.mode)

    def advance(self, dt: float, now: TutorialObservation) -> TutorialStep | None:
        before, self._before = self._before or now, now
        if self.praised is not None:
            self._praise_s -= dt
            if self._praise_s > 0.0:
                return None
            self.praised = None
        step = self.step
        if step is None:
            return None
        if step in (TutorialStep.BEST_VIEW, TutorialStep.LOWER):
            # The next point is marked from this step on.
            self._first.has_points = True
        first = self._first_seen or before
        if first.yaw_deg is None and before.yaw_deg is not None:
            # The headset's controllers have only now been used.
            first = before
        self._first_seen = first
        self._seconds[step.value] = self._seconds.get(step.value, 0.0) + dt
        self._amount = amount_done(step, self._amount, first, before, now)
        if self._amount < step.goal:
            return None
        self._done.append(step)
        self._amount, self._first_seen = 0.0, None
        self.praised, self._praise_s = step, PRAISE_S
        return step

    def touch(self, state: SimulationState) -> TrainingReply:
        reply = self.practice.handle(CommandName.CAPTURE, state)
        if reply.ok and self.practice is self._first and TutorialStep.TOUCH not in self._done:
            (self._first_error_mm,) = self._first.errors_mm()
        return reply

    def outcome(self, device: SourceKind) -> TutorialOutcome:
        return TutorialOutcome(
            trainee=self.trainee,
            device=device.value,
            mode=self.mode,
            duration_s=round(sum(self._seconds.values()), 3),
            first_error_mm=round(self._first_error_mm, 3),
            errors_mm=tuple(round(error, 3) for error in self._guided.errors_mm()),
            step_times_s={step: round(time, 3) for step, time in self._seconds.items()},
        )
