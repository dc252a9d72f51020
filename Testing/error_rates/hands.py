"""Trials that the same scripted hands have played on every task of three heads.

`played_hands.csv` holds of each trial the time, the contacts and how far each touch was from its
fiducial. `python -m Testing.error_rates.hands` plays those that it lacks, some seconds each.
"""

from __future__ import annotations

import functools
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rastrainer.registration.target_error import true_touch_errors
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.scoring import SAFETY_METRICS
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.virtual.hand import Skill
from Testing.error_rates.row_files import Floats, play_missing, stored_rows
from Testing.simulator.authoring.planned_heads import setup_of
from Testing.simulator.virtual.cheating_trainees import play_honestly

FILE = Path(__file__).with_name("played_hands.csv")
TASKS = ("trial-run", "task-1", "task-2", "task-3", "task-4", "task-5")
HEADS = ("colin27", "egg", "small")
USUAL, SLOW = "usual", "slow"
SKILLS = {
    USUAL: Skill(),
    SLOW: Skill(
        speed_mm_s=70.0,
        gain_per_s=2.0,
        aim_sd_mm=1.2,
        drift_mm_s=2.7,
        reaction_s=0.4,
        dwell_s=0.5,
    ),
}
SEEDS = {USUAL: range(1, 16), SLOW: range(1, 13)}
"""Seeds of the head's pose and of the hands."""


@dataclass(frozen=True)
class HandsTrial:
    """One trial: the time and path of unintended contact, how deep the tool was pressed in, and
    from each fiducial to where it was touched, RAS, mm."""

    hands: str
    seed: int
    head: str
    task: str
    time_s: float
    safety: Floats
    touch_errors_mm: Floats

    @property
    def errors_mm(self) -> np.ndarray:
        return np.reshape(self.touch_errors_mm, (15, 3))


def keys() -> Iterator[tuple[str, int, str, str]]:
    """Yield hands, seed, head and task of all trials that the file is to hold."""
    for hands, seeds in SEEDS.items():
        for seed in seeds:
            yield from ((hands, seed, head, task) for head in HEADS for task in TASKS)


def play(hands: str, seed: int, head: str, task: str) -> HandsTrial:
    played = play_honestly(setup(head), task, seed, SKILLS[hands])
    record, truth = played.record, played.truth
    fiducials = np.array([truth.fiducials_ras[label] for label in record.labels])
    safety = tuple(round(float(record.motion[name]), 4) for name in SAFETY_METRICS)
    errors = true_touch_errors(record.positions_mm, truth.head_to_world, fiducials)
    # In the order of the task.
    order = [record.labels.index(label) for label in truth.fiducials_ras]
    kept = tuple(errors[order].round(2).ravel().tolist())
    return HandsTrial(hands, seed, head, task, round(record.completion_time_s, 2), safety, kept)


@functools.cache
def stored() -> dict[tuple[str, int, str, str], HandsTrial]:
    return {(one.hands, one.seed, one.head, one.task): one for one in stored_rows(FILE, HandsTrial)}


def trials_of(hands: str, head: str, task: str) -> list[HandsTrial]:
    return [
        one for one in stored().values() if (one.hands, one.head, one.task) == (hands, head, task)
    ]


def scenario_of(head: str) -> Scenario:
    return setup(head).scenario


@functools.cache
def setup(head: str) -> SimulationSetup:
    """Return the setup of one of the three heads; its files remain until the program ends."""
    return setup_of(head, Path(_folder().name))


@functools.cache
def _folder() -> tempfile.TemporaryDirectory:
    return tempfile.TemporaryDirectory()


if __name__ == "__main__":
    play_missing(FILE, HandsTrial, keys(), play, names=4)
