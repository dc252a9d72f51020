"""Touches outside of a trial: by its rules, at some points, and recorded nowhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rastrainer.head.trial_head import Perturbation
from rastrainer.protocol import TRIAL_RUN, CommandName
from rastrainer.scenario.points import Task
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.ops.texts.texts import Texts
from rastrainer_simulator.state import OperatorCommand, SimulationState, TouchStage, TrainingState
from rastrainer_simulator.training.rules import TouchMoment, touch_stage
from rastrainer_simulator.training.training import Training, TrainingReply
from rastrainer_simulator.training.true_error import Truth
from rastrainer_simulator.vectors import Vector, distance, in_millimeters, vector

_NOT_MOVED = Perturbation(0.0, 0.0, 0.0)


class TouchPractice:
    """Some points of the trial run, touched while no trial is open.

    The rules are those of a trial, whose state machine is used, but the simulation, its clients and
    the journals know nothing of it: only what the views show is changed (`shown`).

    Attributes:
        truth: where the head and the points are.
        has_points: whether the views mark the next point.
    """

    def __init__(
        self,
        setup: SimulationSetup,
        state: SimulationState,
        arguments: dict[str, str],
        points: slice,
        texts: Texts,
        rest: Vector | None = None,
    ) -> None:
        """Begin; the head stays where it is.

        Args:
            setup: the simulation's.
            state: in which it is.
            arguments: checked ones of StartTask, with `trialId`.
            points: which are touched.
            texts: the sentences.
            rest: where the tip may still be on the skin from a touch before, World, m.
        """
        self._rest = rest
        self._settings = setup.settings.training
        scenario = _short_scenario(setup.scenario, state.head_to_world, points)
        self._training = Training(scenario, 0, self._settings, texts)
        start = {**arguments, "task": scenario.tasks[0].name}
        self._training.handle(OperatorCommand(CommandName.START_TASK, start), _moment(state))
        self.has_points = False
        self._shown = self._present()

    @property
    def truth(self) -> Truth:
        """Where the head and the points are."""
        return self._training.truth

    @property
    def goal(self) -> Vector | None:
        """Where the next point is, World, m; None without one."""
        return self._training.goal

    @property
    def state(self) -> TrainingState:
        """How far the touches are."""
        return self._training.state

    def touch(self, state: SimulationState) -> TrainingReply:
        """Record a touch, or refuse it."""
        return self._handle(CommandName.CAPTURE, state)

    def undo(self, state: SimulationState) -> TrainingReply:
        """Undo the last touch."""
        return self._handle(CommandName.UNDO, state)

    def show_points(self) -> None:
        """Have the views mark the next point from now on."""
        self.has_points = True
        self._shown = self._present()

    def errors_mm(self) -> tuple[float, ...]:
        """Return how far each kept touch is from its point, in mm."""
        touches = ((t.label, in_millimeters(t.position)) for t in self.state.touches)
        return tuple(self.truth.touch_errors_mm(touches).values())

    def shown(self, state: SimulationState) -> SimulationState:
        """Return a state of the simulation as the views show it; called in any thread."""
        training, goal = self._shown
        # What stops the arm is not in the state; that it is stopped is.
        obstacle = state.touch.value if state.touch is TouchStage.ARM else ""
        stage = touch_stage(
            _moment(state), state.proximity, obstacle, training, goal, self._settings
        )
        if stage is TouchStage.ELSEWHERE and self._is_at_rest(state):
            stage = TouchStage.NEAR
        return replace(state, training=training, touch=stage)

    def _is_at_rest(self, state: SimulationState) -> bool:
        radius = self._settings.acceptance_radius
        return self._rest is not None and distance(_tip(state), self._rest) <= radius

    def _handle(self, command: str, state: SimulationState) -> TrainingReply:
        reply = self._training.handle(OperatorCommand(command), _moment(state))
        self._shown = self._present()
        return reply

    def _present(self) -> tuple[TrainingState, Vector | None]:
        if self.has_points:
            return self.state, self._training.goal
        return replace(self.state, next_point=None), None


def _short_scenario(scenario: Scenario, head_to_world: np.ndarray, points: slice) -> Scenario:
    """Return a scenario with some points of its trial run, and the head at a pose in m."""
    pose = head_to_world.copy()
    pose[:3, 3] *= MM_PER_M
    task = _first_task(scenario)
    short = replace(task, labels=task.labels[points], fiducials=task.fiducials[points])
    return replace(scenario, tasks=(short,), head_to_world=pose, perturbation=_NOT_MOVED)


def _first_task(scenario: Scenario) -> Task:
    return next((task for task in scenario.tasks if task.name == TRIAL_RUN), scenario.tasks[0])


def _moment(state: SimulationState) -> TouchMoment:
    return TouchMoment(state.sim_time, _tip(state), state.tip_clearance, state.depth)


def _tip(state: SimulationState) -> Vector:
    return vector(state.tool_tip_to_world[:3, 3].tolist())
