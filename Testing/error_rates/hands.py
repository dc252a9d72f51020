"""Trials that the same scripted hands have played on every task of three heads.

`played_hands.csv` holds of each trial the time, the contacts and how far each touch was from its
fiducial. `python -m Testing.error_rates.hands` plays those that it lacks, some seconds each.
"""

from __future__ import annotations

import csv
import functools
import sys
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rastrainer.registration.target_error import true_touch_errors
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.scoring import SAFETY_METRICS
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.virtual.scripted_trainee import Skill
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
        tremor_mm_s=6.0,
        reaction_s=0.4,
        dwell_s=0.5,
    ),
}
SEEDS = {USUAL: range(1, 16), SLOW: range(1, 13)}
"""Seeds of the head's pose and of the hands."""


class SafetyMeasures(NamedTuple):
    """Time and path of unintended contact (s, mm) and how deep the tool was pressed in (mm)."""

    contact_time_s: float
    contact_path_mm: float
    pressing_depth_mm: float


@dataclass(frozen=True, eq=False)
class HandsTrial:
    """One trial.

    Attributes:
        hands: one of `SKILLS`.
        head: one of `HEADS`.
        task: of the head.
        seed: of the head's pose and of the hands.
        time_s: completion time.
        safety: contacts and pressing.
        errors_mm: (15, 3) float, RAS, from each fiducial to where it was touched.
    """

    hands: str
    head: str
    task: str
    seed: int
    time_s: float
    safety: SafetyMeasures
    errors_mm: np.ndarray

    @property
    def key(self) -> tuple[str, int, str, str]:
        """What there is one trial of."""
        return self.hands, self.seed, self.head, self.task


def keys() -> Iterator[tuple[str, int, str, str]]:
    """Yield hands, seed, head and task of all trials that the file is to hold."""
    for hands, seeds in SEEDS.items():
        for seed in seeds:
            yield from ((hands, seed, head, task) for head in HEADS for task in TASKS)


def play(hands: str, seed: int, head: str, task: str) -> HandsTrial:
    """Play one trial."""
    played = play_honestly(setup(head), task, seed, SKILLS[hands])
    record, truth = played.record, played.truth
    fiducials = np.array([truth.fiducials_ras[label] for label in record.labels])
    safety = SafetyMeasures(*(round(float(record.motion[name]), 4) for name in SAFETY_METRICS))
    errors = true_touch_errors(record.positions_mm, truth.head_to_world, fiducials)
    # In the order of the task.
    order = [record.labels.index(label) for label in truth.fiducials_ras]
    time_s = round(record.completion_time_s, 2)
    return HandsTrial(hands, head, task, seed, time_s, safety, errors[order].round(2))


@functools.cache
def stored() -> dict[tuple[str, int, str, str], HandsTrial]:
    """Return the trials of the file."""
    found = {}
    with FILE.open(encoding="utf-8", newline="") as file:
        for hands, seed, head, task, *values in list(csv.reader(file))[1:]:
            time_s, *others = map(float, values)
            safety, errors = SafetyMeasures(*others[:3]), np.reshape(others[3:], (15, 3))
            trial = HandsTrial(hands, head, task, int(seed), time_s, safety, errors)
            found[trial.key] = trial
    return found


def trials_of(hands: str, head: str, task: str) -> list[HandsTrial]:
    """Return the stored trials of some hands on one task."""
    return [
        one for one in stored().values() if (one.hands, one.head, one.task) == (hands, head, task)
    ]


def write(trials: Iterable[HandsTrial]) -> None:
    """Write trials into the file, in the order of `keys`."""
    order = {key: number for number, key in enumerate(keys())}
    with FILE.open("w", encoding="utf-8", newline="") as file:
        lines = csv.writer(file, lineterminator="\n")
        axes = [f"{axis}{number}_mm" for number in range(1, 16) for axis in "ras"]
        lines.writerow(["hands", "seed", "head", "task", "time_s", *SAFETY_METRICS, *axes])
        for one in sorted(trials, key=lambda one: order[one.key]):
            numbers = [one.time_s, *one.safety, *one.errors_mm.ravel()]
            lines.writerow([*one.key, *(f"{number:.10g}" for number in numbers)])


def scenario_of(head: str) -> Scenario:
    """Return the scenario of one of the three heads."""
    return setup(head).scenario


@functools.cache
def setup(head: str) -> SimulationSetup:
    """Return the setup of one of the three heads; its files remain until the program ends."""
    return setup_of(head, Path(_folder().name))


@functools.cache
def _folder() -> tempfile.TemporaryDirectory:
    return tempfile.TemporaryDirectory()


def main() -> int:
    """Play the missing trials."""
    trials = dict(stored()) if FILE.is_file() else {}
    for key in keys():
        if key in trials:
            continue
        trials[key] = play(*key)
        write(trials.values())
        print(*key, trials[key].time_s, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
