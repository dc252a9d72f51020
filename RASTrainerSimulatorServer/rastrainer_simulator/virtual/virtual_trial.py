"""A trial that a scripted trainee plays in one process, faster than real time, for cohorts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer.command_arguments import check_arguments
from rastrainer.errors import RASTrainerError
from rastrainer.protocol import CommandName, Mode, Phase, Proximity
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.operator_input import HANDS_OFF, OperatorCommand, OperatorInput
from rastrainer_simulator.state import SimulationState, StepResult
from rastrainer_simulator.virtual.scripted_trainee import (
    Action,
    Observation,
    ScriptedTrainee,
    Skill,
)

LONGEST_S = 1800.0
NOTHING: Mapping[str, Any] = {}

OnStep = Callable[[Simulation, SimulationState, OperatorInput, StepResult], Any]
"""Called with the simulation, the state before, the input and the result of each step."""


class UnfinishedTrialError(RASTrainerError):
    """The scripted trainee did not touch all fiducials in half an hour of simulated time."""


@dataclass(frozen=True)
class VirtualTrial:
    """What a played trial left behind, and the truth that only a simulation knows.

    Attributes:
        touches_mm: (15, 3) float, World, mm, in the order of the task.
        fiducials_mm: (15, 3) float, the same points in the MRI, RAS mm.
        head_to_world: (4, 4) float, mm.
        completion_time_s: simulated time from the start to the last touch.
    """

    touches_mm: np.ndarray
    fiducials_mm: np.ndarray
    head_to_world: np.ndarray
    completion_time_s: float


def play_virtual_trial(
    simulation: Simulation,
    task_name: str,
    seed: int,
    skill: Skill,
    dt: float,
    on_step: OnStep | None = None,
    trainee: str | None = None,
    mode: Mode = Mode.DESKTOP,
    trial_id: str | None = None,
) -> VirtualTrial:
    """Play one task to its registration; the simulation is left in the phase `registered`.

    Args:
        simulation: free for the next trial.
        task_name: of the scenario.
        seed: of the head's pose and of the hands.
        skill: of the hands.
        dt: the simulation's step in s.
        on_step: is called after each step as a recorder wants it.
        trainee: pseudonym; by default derived from the seed.
        mode: goes into the record; the hands do not see it.
        trial_id: UUID; by default derived from the simulation's seed and the trial's number.

    Raises:
        InputError: there is no such task.
        UnfinishedTrialError: the trainee did not get to a fiducial.
    """
    scenario = simulation.setup.scenario
    task = scenario.task(task_name)
    head_to_world = scenario.perturbed_head_to_world(seed)
    hands = ScriptedTrainee.of(scenario, task_name, head_to_world, skill, seed)
    start = {
        "task": task_name,
        "trainee": trainee or f"virtual-{seed}",
        "mode": mode.value,
        "seed": seed,
    }

    def step(action: Action | None, own: Mapping[str, Any] = NOTHING) -> StepResult:
        before, operator_input = simulation.state, _input(action, own)
        result = simulation.step(dt, operator_input)
        if on_step is not None:
            on_step(simulation, before, operator_input, result)
        return result

    own = {} if trial_id is None else {"trialId": trial_id}
    state = step((CommandName.START_TASK, start), own).state
    while state.training.phase is not Phase.REGISTERED:
        if state.elapsed > LONGEST_S:
            raise UnfinishedTrialError(
                f"The scripted trainee of seed {seed} did not finish {task_name} in "
                f"{LONGEST_S:g} s: it is at point {state.training.next_point}."
            )
        action = hands.decide(_observation(state))
        result = step(action)
        state = result.state
        if action is not None and action[0] == CommandName.CAPTURE and not result.answers[0].ok:
            hands.touch_refused()
    touches = state.training.touches
    return VirtualTrial(
        touches_mm=MM_PER_M * np.array([touch.position for touch in touches]),
        fiducials_mm=task.fiducials,
        head_to_world=head_to_world,
        completion_time_s=touches[-1].elapsed,
    )


def _input(action: Action | None, own: Mapping[str, Any]) -> OperatorInput:
    """Return an action as the operator's input; `own` are arguments that no client may send."""
    if action is None:
        return HANDS_OFF
    name, arguments = action
    return OperatorInput(
        commands=(OperatorCommand(name, {**check_arguments(name, arguments), **own}),)
    )


def _observation(state: SimulationState) -> Observation:
    point = state.training.next_point
    return Observation(
        sim_time_s=state.sim_time,
        tip_mm=MM_PER_M * state.tool_tip_to_world[:3, 3],
        is_in_contact=state.proximity is Proximity.CONTACT,
        phase=state.training.phase,
        next_point=None if point is None else int(point),
    )
