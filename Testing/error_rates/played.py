"""Trials that honest and cheating trainees have played on Colin27.

`python -m Testing.error_rates.played` plays all of them that `played_trials.csv` does not hold,
some seconds each. The measures of a score are kept, so that another score needs no new trials
unless it measures more.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np

from rastrainer.registration.registration import register
from rastrainer.registration.target_error import common_bias, true_touch_errors
from rastrainer.trial.score_reference import fiducial_normals, region_of, score_reference
from rastrainer.trial.scoring import ScoreMeasures, TrialScore, score_trial
from rastrainer_simulator.core.setup import SimulationSetup
from Testing.error_rates.hands import HEADS, TASKS, setup
from Testing.error_rates.row_files import play_missing, stored_rows
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


@dataclass(frozen=True)
class Played:
    """The measures of one played trial; the seed is of the head's pose and the hands."""

    way: str
    task: str
    seed: int
    completion_time_s: float
    tre_mm: float
    contact_time_s: float
    contact_path_mm: float
    pressing_depth_mm: float
    common_bias_mm: float

    @property
    def score(self) -> TrialScore:
        reference = score_reference(setup(COLIN27).scenario, self.task)
        return score_trial(ScoreMeasures(*astuple(self)[3:]), reference)


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
    measures = measures_of(setup(COLIN27), WAYS[way](setup(COLIN27), task, seed))
    return Played(way, task, seed, *(round(value, 4) for value in astuple(measures)))


@functools.cache
def stored() -> dict[tuple[str, str, int], Played]:
    return {(one.way, one.task, one.seed): one for one in stored_rows(FILE, Played)}


def keys(way: str) -> Iterator[tuple[str, str, int]]:
    """Yield strategy, task and seed of all trials of a strategy."""
    return ((way, task, seed + 1) for seed in range(FEW.get(way, 3)) for task in TASKS)


if __name__ == "__main__":
    play_missing(FILE, Played, (key for way in WAYS for key in keys(way)), play, names=3)
