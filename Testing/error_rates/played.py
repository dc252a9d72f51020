"""Trials that honest and cheating trainees have played on Colin27.

`python -m Testing.error_rates.played` plays all of them that `played_trials.csv` does not hold,
some seconds each. The measures of a score are kept, so that another score needs no new trials
unless it measures more.
"""

from __future__ import annotations

import csv
import functools
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rastrainer.registration.registration import register
from rastrainer.registration.target_error import common_bias, true_touch_errors
from rastrainer.trial.score_reference import fiducial_normals, region_of, score_reference
from rastrainer.trial.scoring import ScoreMeasures, TrialScore, score_trial
from rastrainer_simulator.core.setup import SimulationSetup
from Testing.error_rates.hands import HEADS, TASKS, setup
from Testing.simulator.virtual.cheating_trainees import (
    BIAS_MM,
    PlayedTrial,
    aim_off_target,
    drag,
    hover,
    play_honestly,
    press,
)

FILE = Path(__file__).with_name("played_trials.csv")
Play = Callable[[SimulationSetup, str, int], PlayedTrial]
OBLIQUE = ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))
"""Directions of World between the axes, to four corners of a cube."""
AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)} | {
    "".join("+" if part > 0 else "-" for part in each): each for each in OBLIQUE
}


def _aim(direction: tuple[int, ...]) -> Play:
    bias = BIAS_MM * np.array(direction) / np.linalg.norm(direction)
    return functools.partial(aim_off_target, bias_mm=tuple(bias.tolist()))


WAYS: dict[str, Play] = {
    "honest": play_honestly,
    "hover": hover,
    "hover 2 mm": functools.partial(hover, by_mm=2.0),
    "drag": drag,
    "press": press,
    "aim beside": aim_off_target,
    **{f"aim beside, {name}": _aim(direction) for name, direction in AXES.items()},
}
OBLIQUE_WAYS = tuple(f"aim beside, {name}" for name in list(AXES)[3:])
COLIN27 = HEADS[0]
FEW = {"hover": 2, "hover 2 mm": 1, "drag": 2, "press": 2}
"""Number of trials of each task; three for the other strategies."""


def seeds(way: str) -> range:
    """Return the seeds, of the head's pose and of the hands, with which a strategy is played."""
    return range(1, FEW.get(way, 3) + 1)


@dataclass(frozen=True)
class Played:
    """The measures of one played trial.

    Attributes:
        way: one of `WAYS`.
        task: of the head.
        seed: of the head's pose and the hands.
    """

    way: str
    task: str
    seed: int
    measures: ScoreMeasures

    @property
    def key(self) -> tuple[str, str, int]:
        """What there is one trial of."""
        return self.way, self.task, self.seed


def measures_of(setup: SimulationSetup, played: PlayedTrial) -> ScoreMeasures:
    """Return the measures of a trial, with the rigid registration of all its touches."""
    record, truth = played.record, played.truth
    fiducials = np.array([truth.fiducials_ras[label] for label in record.labels])
    fit = register(record.positions_mm, fiducials)
    tre_mm = region_of(setup.scenario).tre_mm(fit.matrix, truth.head_to_world)
    errors = true_touch_errors(record.positions_mm, truth.head_to_world, fiducials)
    labels = list(truth.fiducials_ras)
    normals = fiducial_normals(setup.scenario, record.task)
    normals = normals[[labels.index(label) for label in record.labels]]
    bias_mm = common_bias(errors, normals).length_mm
    return ScoreMeasures.of(record.completion_time_s, tre_mm, bias_mm, record.motion)


def score_of(setup: SimulationSetup, played: PlayedTrial) -> TrialScore:
    """Return the score of a trial against the reference of its scenario."""
    reference = score_reference(setup.scenario, played.record.task)
    return score_trial(measures_of(setup, played), reference)


def play(way: str, task: str, seed: int) -> Played:
    """Play one trial."""
    measures = measures_of(setup(COLIN27), WAYS[way](setup(COLIN27), task, seed))
    rounded = {name: round(value, 4) for name, value in vars(measures).items()}
    return Played(way, task, seed, replace(measures, **rounded))


@functools.cache
def stored() -> tuple[Played, ...]:
    """Return the trials of the file."""
    if not FILE.is_file():
        return ()
    with FILE.open(encoding="utf-8", newline="") as file:
        return tuple(
            Played(way, task, int(seed), ScoreMeasures(*map(float, values)))
            for way, task, seed, *values in list(csv.reader(file))[1:]
        )


def all_keys() -> Iterator[tuple[str, str, int]]:
    """Yield strategy, task and seed of all trials that the file should hold."""
    for way in WAYS:
        yield from ((way, task, seed) for seed in seeds(way) for task in TASKS)


def write(trials: list[Played]) -> None:
    """Write trials into the file, in the order of `all_keys`."""
    order = {key: number for number, key in enumerate(all_keys())}
    names = list(ScoreMeasures.__annotations__)
    with FILE.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["way", "task", "seed", *names])
        for one in sorted(trials, key=lambda one: order[one.key]):
            rows.writerow([*one.key, *vars(one.measures).values()])


def main() -> int:
    """Play the missing trials."""
    trials = list(stored())
    there = {one.key for one in trials}
    for key in all_keys():
        if key in there:
            continue
        trials.append(play(*key))
        write(trials)
        print(*key, vars(trials[-1].measures), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
