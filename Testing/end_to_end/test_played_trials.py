"""Whole trials, played, recorded and replayed: what the trainee is shown about them is true."""

from __future__ import annotations

import math
import multiprocessing
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.head.mesh import outward_normals, read_head_mesh
from rastrainer.journal.journal_file import read_journal
from rastrainer.registration.localization_error import error_along_surface
from rastrainer.registration.registration import register
from rastrainer.registration.target_error import target_error
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.setup import SimulationSetup, load_setup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.record.trial_archive import SUFFIX, TrialArchive
from rastrainer_simulator.record.trial_recorder import TrialRecorder
from rastrainer_simulator.replay.resimulation import replay
from rastrainer_simulator.virtual.play import play_virtual_trial
from Testing.simulator.virtual.conftest import BRISK

STEP_S = 0.05
TRIALS = 100


class Played(NamedTuple):
    """What one trial showed."""

    is_within_interval: bool
    difference: str | None
    compared_touches: int
    compared_postures: int


def played_trials(seeds: range) -> list[Played]:
    setup = load_setup()
    simulation = Simulation(setup, seed=0)
    with tempfile.TemporaryDirectory() as folder:
        return [play(simulation, setup, seed, Path(folder)) for seed in seeds]


def play(simulation: Simulation, setup: SimulationSetup, seed: int, folder: Path) -> Played:
    tasks = setup.scenario.tasks
    with ThreadPoolExecutor(max_workers=1) as writer:
        recorder = TrialRecorder(folder, TrialArchive(folder), writer, STEP_S)
        task = tasks[seed % len(tasks)].name
        play_virtual_trial(simulation, task, seed, BRISK, STEP_S, recorder.record)
        recorder.stop(simulation.state)
    (journal,) = folder.glob(f"*{SUFFIX}")
    report = replay(read_journal(journal), setup)
    journal.unlink()
    touches_mm = MM_PER_M * np.array([one.position for one in simulation.state.training.touches])
    is_within = is_within_interval(touches_mm, task, seed, setup.scenario)
    return Played(is_within, report.difference, report.compared["touch"], report.ticks)


def is_within_interval(touches_mm: np.ndarray, task: str, seed: int, scenario: Scenario) -> bool:
    target, fiducials_mm = scenario.target.position_ras, scenario.task(task).fiducials
    registration = register(touches_mm, fiducials_mm)
    head_to_world = scenario.perturbed_head_to_world(seed)
    there_and_back = transforms.apply(registration.matrix @ head_to_world, target[None])
    true_tre_mm = np.linalg.norm(there_and_back[0] - target)
    normals = outward_normals(read_head_mesh(scenario.head), fiducials_mm)
    error = target_error(registration, target, error_along_surface(registration, normals))
    low, high = error.interval_mm
    return bool(low <= true_tre_mm <= high)


def test_a_played_trial_replays_to_the_last_bit():
    check_replays(played_trials(range(1)))


@pytest.mark.soak
def test_true_errors_of_played_trials_lie_in_the_reported_interval_as_often_as_stated():
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        halves = pool.map(played_trials, [range(0, TRIALS, 2), range(1, TRIALS, 2)])
    played = [trial for half in halves for trial in half]
    check_replays(played)
    expected = 0.95 * TRIALS
    # Three standard deviations of so many trials.
    fewest = expected - 3.0 * math.sqrt(0.05 * expected)
    assert sum(trial.is_within_interval for trial in played) >= fewest


def check_replays(played: list[Played]) -> None:
    assert [trial.difference for trial in played] == [None] * len(played)
    assert all(trial.compared_touches >= 15 for trial in played)
    assert all(trial.compared_postures > 100 for trial in played)
