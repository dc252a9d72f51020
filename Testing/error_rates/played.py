"""Trials that honest and cheating trainees have played, kept beside the tables made of them.

`python -m Testing.error_rates.played` plays all of them that `played_trials.csv` does not hold,
some seconds each. What is kept is what is scored, so that another score needs no new trials unless
it measures more.
"""

from __future__ import annotations

import csv
import functools
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rastrainer.registration.registration import register
from rastrainer.trial.score_reference import fiducial_normals, region_of, score_reference
from rastrainer.trial.scoring import ScoreMeasures, TrialScore, score_trial
from rastrainer.trial.trueness import common_bias, true_touch_errors
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.virtual.scripted_trainee import Skill
from Testing.simulator.authoring.planned_heads import setup_of
from Testing.simulator.virtual.cheating_trainees import (
    BIAS_MM,
    PlayedTrial,
    aim_beside,
    drag,
    hover,
    play_honestly,
    press,
)

FILE = Path(__file__).with_name("played_trials.csv")
TASKS = ("trial-run", "task-1", "task-2", "task-3", "task-4", "task-5")
HEADS = ("colin27", "egg", "small")
USUAL, SLOW = "usual", "slow"
SLOW_SKILL = Skill(
    speed_mm_s=70.0, gain_per_s=2.0, aim_sd_mm=1.2, tremor_mm_s=6.0, reaction_s=0.4, dwell_s=0.5
)
"""Slower hands, and less exact ones: FLE 1.7 mm."""
Play = Callable[[SimulationSetup, str, int], PlayedTrial]
OBLIQUE = ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))
"""Directions of World between the axes, to four corners of a cube."""
AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)} | {
    "".join("+" if part > 0 else "-" for part in each): each for each in OBLIQUE
}


def _aim(direction: tuple[int, ...]) -> Play:
    bias = BIAS_MM * np.array(direction) / np.linalg.norm(direction)
    return functools.partial(aim_beside, bias_mm=tuple(bias.tolist()))


WAYS: dict[str, Play] = {
    USUAL: functools.partial(play_honestly, skill=Skill()),
    SLOW: functools.partial(play_honestly, skill=SLOW_SKILL),
    "honest": play_honestly,
    "hover": hover,
    "hover 2 mm": functools.partial(hover, by_mm=2.0),
    "drag": drag,
    "press": press,
    "aim beside": aim_beside,
    **{f"aim beside, {name}": _aim(direction) for name, direction in AXES.items()},
}
OBLIQUE_WAYS = tuple(f"aim beside, {name}" for name in list(AXES)[3:])
FEW = {"hover": 2, "hover 2 mm": 1, "drag": 2, "press": 2, SLOW: 1}
"""Trials of each task on Colin27; three of the other ways."""
FEW_ON_OTHER_HEADS = {USUAL: 3, SLOW: 1}


def seeds(head: str, way: str) -> range:
    """Return the seeds, of the head's pose and of the hands, with which a way is played."""
    few = FEW.get(way, 3) if head == HEADS[0] else FEW_ON_OTHER_HEADS.get(way, 0)
    return range(1, few + 1)


@dataclass(frozen=True)
class Played:
    """What is scored of one played trial, and what it was.

    Attributes:
        head: one of `HEADS`.
        way: one of `WAYS`.
        task: of the head.
        seed: of the head's pose and the hands.
        measures: what is scored.
    """

    head: str
    way: str
    task: str
    seed: int
    measures: ScoreMeasures

    @property
    def key(self) -> tuple[str, str, str, int]:
        """What there is one trial of."""
        return self.head, self.way, self.task, self.seed


def measures_of(setup: SimulationSetup, played: PlayedTrial) -> ScoreMeasures:
    """Return what is scored of a trial: of the rigid registration of all its touches."""
    record, truth = played.record, played.truth
    fiducials = np.array([truth.fiducials[label] for label in record.labels])
    fit = register(record.positions_mm, fiducials)
    tre_mm = region_of(setup.scenario).tre_mm(fit.matrix, truth.head_to_world)
    errors = true_touch_errors(record.positions_mm, truth.head_to_world, fiducials)
    labels = list(truth.fiducials)
    normals = fiducial_normals(setup.scenario, record.task)
    normals = normals[[labels.index(label) for label in record.labels]]
    bias_mm = common_bias(errors, normals).length_mm
    return ScoreMeasures.of(record.completion_time_s, tre_mm, bias_mm, record.motion)


def score_of(setup: SimulationSetup, played: PlayedTrial) -> TrialScore:
    """Return the score of a trial against the reference of its scenario."""
    reference = score_reference(setup.scenario, played.record.task)
    return score_trial(measures_of(setup, played), reference)


def play(setup: SimulationSetup, head: str, way: str, task: str, seed: int) -> Played:
    """Play one trial."""
    measures = measures_of(setup, WAYS[way](setup, task, seed))
    rounded = {name: round(value, 4) for name, value in vars(measures).items()}
    return Played(head, way, task, seed, replace(measures, **rounded))


@functools.cache
def stored() -> tuple[Played, ...]:
    """Return the trials of the file."""
    if not FILE.is_file():
        return ()
    with FILE.open(encoding="utf-8", newline="") as file:
        return tuple(
            Played(head, way, task, int(seed), ScoreMeasures(*map(float, values)))
            for head, way, task, seed, *values in list(csv.reader(file))[1:]
        )


def all_keys() -> Iterator[tuple[str, str, str, int]]:
    """Yield head, way, task and seed of all trials that the file is to hold."""
    for way in WAYS:
        for head in HEADS:
            yield from ((head, way, task, seed) for seed in seeds(head, way) for task in TASKS)


def write(trials: list[Played]) -> None:
    """Write trials into the file, in the order of `all_keys`."""
    order = {key: number for number, key in enumerate(all_keys())}
    names = list(ScoreMeasures.__annotations__)
    with FILE.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["head", "way", "task", "seed", *names])
        for one in sorted(trials, key=lambda one: order[one.key]):
            rows.writerow([*one.key, *vars(one.measures).values()])


def main() -> int:
    """Play what is missing."""
    trials = list(stored())
    there = {one.key for one in trials}
    with tempfile.TemporaryDirectory() as folder:
        setups: dict[str, SimulationSetup] = {}
        for key in all_keys():
            if key in there:
                continue
            if key[0] not in setups:
                setups[key[0]] = setup_of(key[0], Path(folder))
            trials.append(play(setups[key[0]], *key))
            write(trials)
            print(*key, vars(trials[-1].measures), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
