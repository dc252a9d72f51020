"""Every method of registration on Colin27: does its interval hold the truth, and which is better?

`method_errors.csv` has the played trials, fifty a row. `python -m
Testing.error_rates.method_errors` plays the rows that it lacks of 2,000 trials for each method and
shift, all methods in turn. It can be stopped at any time: the table says how many were played.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rastrainer.number_text import fixed
from rastrainer.protocol import RegistrationMethod
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.virtual.method_trials import METHODS, MethodStudy
from Testing.error_rates.measured import Measured
from Testing.error_rates.row_files import play_missing, stored_rows
from Testing.simulator.landmarked import with_landmarks

HEADER = (
    "method, and shift of the skin",
    "interval holds the true TRE",
    "residual, RMS, mm",
    "expected TRE, RMS, mm",
    "true TRE, RMS, mm",
    "trials",
)
FILE = Path(__file__).with_name("method_errors.csv")
SHIFTS_MM = (0.0, 2.0)
CHUNK, TRIALS = 50, 2000
STARTS = 1
"""Starts of a surface match: more would find gross errors of the landmarks, and cost time."""
LEAST_HELD, MOST_HELD = 0.93, 0.97


@dataclass(frozen=True)
class Chunk:
    """Sums over some trials of one method; squares in mm²."""

    method: str
    shift_mm: float
    chunk: int
    trials: int
    held: int
    residual2: float
    expected2: float
    true2: float


def measured(trials: int) -> list[Measured]:
    """Return the table: of what the file holds if all trials are asked for, else played anew."""
    chunks = (
        stored_rows(FILE, Chunk)
        if trials >= TRIALS
        else [play(*key, trials) for key in keys(trials)]
    )
    rows = []
    for shift, method in itertools.product(SHIFTS_MM, METHODS):
        own = [c for c in chunks if (c.method, c.shift_mm) == (method.value, shift)]
        count = sum(one.trials for one in own)
        means = [
            fixed(float(np.sqrt(sum(getattr(one, name) for one in own) / count)), 2)
            for name in ("residual2", "expected2", "true2")
        ]
        words = f"{method.value}, {f'{shift:g} mm' if shift else 'no shift'}"
        rows.append(
            Measured(
                words,
                sum(one.held for one in own) / count,
                count,
                at_most=None if shift else MOST_HELD,
                at_least=None if shift else LEAST_HELD,
                further=(*means, str(count)),
            )
        )
    return rows


def keys(trials: int) -> Iterator[tuple[str, float, int]]:
    """Yield method, shift and chunk of all chunks for so many trials."""
    for chunk in range(-(-trials // CHUNK)):
        for shift, method in itertools.product(SHIFTS_MM, METHODS):
            yield method.value, shift, chunk


@functools.cache
def study(shift_mm: float) -> MethodStudy:
    """Return what the trials with a shift of the skin have in common."""
    scenario = with_landmarks(load_scenario(asset_path("scenarios", "colin27")))
    return MethodStudy(scenario, "task-3", shift_mm, starts=STARTS)


def play(method: str, shift_mm: float, chunk: int, trials: int = CHUNK) -> Chunk:
    """Play the trials of a chunk, or the first of them."""
    seeds = range(CHUNK * chunk, CHUNK * chunk + min(trials, CHUNK))
    results = [study(shift_mm).trial(RegistrationMethod(method), seed) for seed in seeds]
    expected = [error.expected_mm**2 for one in results for error in one.errors]
    true = np.concatenate([one.true_mm for one in results if one.true_mm is not None])
    share = len(results) / len(true)
    return Chunk(
        method,
        shift_mm,
        chunk,
        len(results),
        sum(bool(one.holds[0]) for one in results),
        float(sum(one.residual_mm**2 for one in results)),
        float(share * np.sum(expected)),
        float(share * np.sum(true**2)),
    )


if __name__ == "__main__":
    play_missing(FILE, Chunk, keys(TRIALS), play, names=3)
