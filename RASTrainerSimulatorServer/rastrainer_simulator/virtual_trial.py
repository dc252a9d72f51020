"""A trial that a scripted trainee plays in one process, faster than real time, for cohorts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer import transforms
from rastrainer.errors import RASTrainerError
from rastrainer.protocol import CommandName, Mode, Phase, check_arguments
from rastrainer.scripted_trainee import Observation, ScriptedTrainee, Skill, seeded_skill
from rastrainer_simulator.operator_input import HANDS_OFF, Command, OperatorInput
from rastrainer_simulator.simulation import Simulation
from rastrainer_simulator.state import Answer, SimulationState

MM = 1000.0
LONGEST_S = 1800.0


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
    simulation: Simulation, task_name: str, seed: int, skill: Skill, dt: float
) -> VirtualTrial:
    """Play one task to its registration; the seed is of the head's pose and of the hands.

    `dt` is the simulation's step in s. The simulation is left in the phase `registered`, ready for
    the next trial.

    Raises:
        InputError: there is no such task.
        UnfinishedTrialError: the trainee did not get to a fiducial.
    """
    scenario = simulation.setup.scenario
    task = scenario.task(task_name)
    head_to_world = scenario.perturbed_head_to_world(seed)
    trainee = ScriptedTrainee(
        transforms.apply(head_to_world, task.fiducials),
        transforms.apply(head_to_world, scenario.target_position[None])[0],
        seeded_skill(skill, seed),
        seed,
    )
    start = {
        "task": task_name,
        "trainee": f"virtual-{seed}",
        "mode": Mode.DESKTOP.value,
        "seed": seed,
    }
    state, _ = _step(simulation, dt, (CommandName.START_TASK, start))
    while state.training.phase is not Phase.REGISTERED:
        if state.elapsed > LONGEST_S:
            raise UnfinishedTrialError(
                f"The scripted trainee of seed {seed} did not finish {task_name} in "
                f"{LONGEST_S:g} s: it is at point {state.training.next_point}."
            )
        action = trainee.decide(_observation(state))
        state, answers = _step(simulation, dt, action)
        if action is not None and action[0] == CommandName.CAPTURE and not answers[0].ok:
            trainee.touch_refused()
    touches = state.training.touches
    return VirtualTrial(
        touches_mm=MM * np.array([touch.position for touch in touches]),
        fiducials_mm=task.fiducials,
        head_to_world=head_to_world,
        completion_time_s=touches[-1].elapsed,
    )


def _step(simulation: Simulation, dt: float, action) -> tuple[SimulationState, tuple[Answer, ...]]:
    if action is None:
        result = simulation.step(dt, HANDS_OFF)
    else:
        name, arguments = action
        command = Command(name, check_arguments(name, arguments))
        result = simulation.step(dt, OperatorInput(commands=(command,)))
    return result.state, result.answers


def _observation(state: SimulationState) -> Observation:
    point = state.training.next_point
    return Observation(
        sim_time_s=state.sim_time,
        tip_mm=MM * state.tool_tip_to_world[:3, 3],
        phase=state.training.phase,
        next_point=None if point is None else int(point),
    )
