"""How often aborting bad trials makes a trainee competent, as it did before and does now."""

from __future__ import annotations

import numpy as np

from rastrainer.number_text import fixed
from rastrainer.trial.trainee_progress import competence_of
from Testing.error_rates.measured import Measured, share_of

HEADER = (
    "trainee, 30 trials started",
    "called competent",
    "aborted trials not counted (previous method)",
    "not counted, until 30 are finished (previous method)",
    "trials finished of 30, mean",
)
TRIALS = 30


def competence(sets: int, seed: int = 23) -> list[Measured]:
    """Return how often trainees are called competent who abort each trial that they have seen fail.

    Whoever passes with a probability below that of an adequate trainee is to be called so seldom.
    """
    random = np.random.default_rng(seed)
    return [
        _trainees("passes 50 %, aborts every bad trial", 0.5, 1.0, sets, random, at_most=0.05),
        _trainees("passes 50 %, aborts every second bad trial", 0.5, 0.5, sets, random, 0.05),
        _trainees("passes 50 %, aborts none", 0.5, 0.0, sets, random, at_most=0.05),
        _trainees("passes 60 %, aborts every bad trial", 0.6, 1.0, sets, random, at_most=0.05),
        _trainees("passes 95 %, aborts none", 0.95, 0.0, sets, random, at_least=0.9),
    ]


def _trainees(
    case: str,
    passing: float,
    aborting: float,
    sets: int,
    random: np.random.Generator,
    at_most: float | None = None,
    at_least: float | None = None,
) -> Measured:
    """Simulate trainees; `aborting` is the share of the bad trials that they abort."""
    counted, uncounted, until_finished, finished = [], [], [], []
    for _ in range(sets):
        # Enough for 30 finished ones, however many are aborted.
        failed = random.random(20 * TRIALS) >= passing
        aborted = failed & (random.random(len(failed)) < aborting)
        counted.append(_is_competent(failed[:TRIALS]))
        uncounted.append(_is_competent(failed[:TRIALS][~aborted[:TRIALS]]))
        until_finished.append(_is_competent(failed[~aborted][:TRIALS]))
        finished.append(int(np.sum(~aborted[:TRIALS])))
    beside = (
        *(f"{fixed(100 * share_of(each), 1)} %" for each in (uncounted, until_finished)),
        fixed(float(np.mean(finished)), 1),
    )
    return Measured(case, share_of(counted), sets, at_most, at_least, beside)


def _is_competent(failed: np.ndarray) -> bool:
    return competence_of([bool(each) for each in failed]).competent_at is not None
