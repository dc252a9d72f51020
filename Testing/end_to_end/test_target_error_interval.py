"""What the trainee is told of the target error holds against the simulator's secret."""

from __future__ import annotations

import multiprocessing

import numpy as np

from rastrainer import transforms
from rastrainer.registration import register
from rastrainer.scripted_trainee import Skill
from rastrainer.target_error import target_error
from rastrainer_simulator.setup import load_setup
from rastrainer_simulator.simulation import Simulation
from rastrainer_simulator.virtual_trial import play_virtual_trial

BRISK = Skill(speed_mm_s=300.0, gain_per_s=6.0, reaction_s=0.1, dwell_s=0.04, slip_at=None)
STEP_S = 0.05
SEEDS = range(100)


def within_interval(seeds: list[int]) -> list[bool]:
    simulation = Simulation(load_setup(), seed=0)
    target = simulation.setup.scenario.target_position
    found = []
    for seed in seeds:
        trial = play_virtual_trial(simulation, "task-1", seed, BRISK, STEP_S)
        registration = register(trial.touches_mm, trial.fiducials_mm)
        there_and_back = transforms.apply(registration.matrix @ trial.head_to_world, target[None])
        true_tre_mm = np.linalg.norm(there_and_back[0] - target)
        low, high = target_error(registration, target).interval_mm
        found.append(bool(low <= true_tre_mm <= high))
    return found


def test_true_target_error_lies_in_the_reported_interval_in_at_least_90_of_100_played_trials():
    halves = [list(SEEDS[0::2]), list(SEEDS[1::2])]
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        first, second = pool.map(within_interval, halves)
    found = first + second
    assert len(found) == 100
    assert sum(found) >= 90
