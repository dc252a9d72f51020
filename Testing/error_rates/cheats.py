"""What cheating gains: scores, aborted bad trials, and the throughput of touches with an offset."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from rastrainer.motion.trial_motion import WIDTH_FACTOR, effective_throughput
from rastrainer.number_text import fixed
from rastrainer.trial.scoring import PASS_MARK, passes
from rastrainer.trial.trial_feedback import TRAINING_TRIALS, competence_of
from Testing.error_rates.hands import TASKS
from Testing.error_rates.measured import Measured, share_of
from Testing.error_rates.played import OBLIQUE_WAYS, stored

MOST = 40.0
"""Points that a cheat may get."""
HEADER = ("strategy", "highest score", "passed", f"competent after {TRAINING_TRIALS}", *TASKS)
ROWS: tuple[tuple[str, Sequence[str], float | None], ...] = (
    ("honest, FLE 1 mm", ["honest"], None),
    ("hover with an offset of 9 mm, the paper's touch rule", ["hover"], MOST),
    ("hover with an offset of 2 mm, the paper's touch rule", ["hover 2 mm"], MOST),
    ("drag from fiducial to fiducial", ["drag"], MOST),
    ("press 2 mm into the head", ["press"], MOST),
    ("aim 2 mm off, along the skin as far as possible", ["aim beside"], MOST),
    ("aim 2 mm off along x, to the front", ["aim beside, x"], MOST),
    ("aim 2 mm off along y, to the left", ["aim beside, y"], MOST),
    ("aim 2 mm off along z, upward", ["aim beside, z"], MOST),
    ("aim 2 mm off in four oblique directions", OBLIQUE_WAYS, MOST),
)


def played(_sets: int) -> list[Measured]:
    """Return the scores of each strategy; a cheat may neither pass nor become competent."""
    return [_scored(*row) for row in ROWS]


def _scored(case: str, ways: Sequence[str], at_most: float | None) -> Measured:
    own = [one for one in stored().values() if one.way in ways]
    by_task = {task: [one.score for one in own if one.task == task] for task in TASKS}
    scores = [*itertools.chain.from_iterable(zip(*by_task.values(), strict=True))]
    failed = [not passes(one.score, one.acceptable, PASS_MARK) for one in scores]
    # The played trials are repeated in order.
    repeated = [*itertools.islice(itertools.cycle(failed), TRAINING_TRIALS)]
    number = competence_of(repeated).competent_at
    means = [float(np.mean([one.score for one in each])) for each in by_task.values()]
    return Measured(
        case,
        max(one.score for one in scores),
        at_most=at_most,
        further=(
            f"{failed.count(False)} of {len(failed)}",
            "no" if number is None else f"at trial {number}",
            *(fixed(mean, 1) for mean in means),
        ),
        is_share=False,
        also=lambda _: at_most is None or (all(failed) and number is None),
    )


ABORTED_HEADER = (
    "trainee, 30 trials started",
    "called competent",
    "trials finished of 30, mean",
)
TRIALS = 30


def competence(sets: int, seed: int = 23) -> list[Measured]:
    """Return how often trainees are called competent who abort trials that go badly.

    Trainees below the adequate pass rate must rarely be called competent.
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
    competent, finished = [], []
    for _ in range(sets):
        failed = random.random(20 * TRIALS) >= passing
        aborted = failed & (random.random(len(failed)) < aborting)
        competent.append(competence_of(failed[:TRIALS].tolist()).competent_at is not None)
        finished.append(np.sum(~aborted[:TRIALS]))
    further = (fixed(float(np.mean(finished)), 1),)
    return Measured(case, share_of(competent), sets, at_most, at_least, further)


THROUGHPUT_HEADER = (
    "offset of all end points, scatter 0.05 mm",
    "trials above 8 bit/s",
    "mean, bit/s",
    "mean by SD about the mean (ISO), bit/s",
)
DISTANCE_MM, TOUCHES = 80.0, 15


def offsets(sets: int, seed: int = 8) -> list[Measured]:
    """Return the throughput of trials with one touch per second, `DISTANCE_MM` apart."""
    random = np.random.default_rng(seed)
    found = []
    for offset in (0.0, 0.5, 2.0, 5.0):
        rates, by_sd = np.array([_throughputs(offset, random) for _ in range(sets)]).T
        further = tuple(fixed(float(each.mean()), 2) for each in (rates, by_sd))
        limit = 0.0 if offset else None
        found.append(Measured(f"{offset:g} mm", share_of(rates > 8), sets, limit, None, further))
    return found


def _throughputs(offset: float, random: np.random.Generator) -> tuple[float, float]:
    """Return our throughput and the standard's, for targets alternating on a line."""
    there = DISTANCE_MM * (np.arange(TOUCHES) % 2)
    ahead = np.where(np.arange(TOUCHES) % 2, 1.0, -1.0)
    further = (offset + random.normal(0, 0.05, TOUCHES)) * ahead
    targets, touches = (
        np.column_stack([x, np.zeros((TOUCHES, 2))]) for x in (there, there + further)
    )
    result = effective_throughput(targets, touches, np.arange(float(TOUCHES)))
    width = WIDTH_FACTOR * np.std((further * ahead)[1:], ddof=1)
    standard = np.log2(np.array(result.effective_distances_mm) / width + 1).mean()
    return result.bits_per_s, float(standard)
