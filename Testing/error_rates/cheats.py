"""What cheating gains: scores, aborted bad trials, and the throughput of touches with an offset."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.motion.trial_motion import WIDTH_FACTOR, effective_throughput
from rastrainer.number_text import fixed
from rastrainer.trial.score_reference import score_reference
from rastrainer.trial.scoring import PASS_MARK, TrialScore, passes, score_trial
from rastrainer.trial.trial_feedback import TRAINING_TRIALS, competence_of
from Testing.error_rates.hands import TASKS, scenario_of
from Testing.error_rates.measured import Measured, share_of
from Testing.error_rates.played import COLIN27, OBLIQUE_WAYS, stored

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


@dataclass(frozen=True)
class Scored:
    """The scores of one strategy.

    Attributes:
        case: the strategy, in words.
        scores: of each trial, by task.
        at_most: no score may exceed it; None if scores are only reported.
    """

    case: str
    scores: dict[str, list[TrialScore]]
    at_most: float | None
    at_least: None = None

    @property
    def highest(self) -> float:
        """The highest score of all trials."""
        return max(one.score for one in self._all())

    @property
    def passed(self) -> int:
        """How many trials pass."""
        return sum(_passes(one) for one in self._all())

    @property
    def competent_at(self) -> int | None:
        """The trial, of thirty, at which LC-CUSUM calls the trainee competent.

        The played trials are repeated in order.
        """
        failures = [not _passes(one) for one in self._all()]
        return competence_of(
            [*itertools.islice(itertools.cycle(failures), TRAINING_TRIALS)]
        ).competent_at

    def holds(self, standard_errors: float = 0.0) -> bool:  # noqa: ARG002
        """Return whether all trials are within the limit and none passes."""
        if self.at_most is None:
            return True
        return self.highest <= self.at_most and not self.passed and self.competent_at is None

    def cells(self) -> list[str]:
        """Return the row of a table."""
        asked = "–" if self.at_most is None else f"≤ {self.at_most:g}"
        number = self.competent_at
        by_task = [
            fixed(float(np.mean([one.score for one in self.scores[task]])), 1)
            if task in self.scores
            else "–"
            for task in TASKS
        ]
        passed = f"{self.passed} of {len(self._all())}"
        competent = "no" if number is None else f"at trial {number}"
        return [self.case, fixed(self.highest, 1), asked, passed, competent, *by_task]

    def _all(self) -> list[TrialScore]:
        return list(itertools.chain.from_iterable(zip(*self.scores.values(), strict=True)))


def _passes(score: TrialScore) -> bool:
    return passes(score.score, score.acceptable, PASS_MARK)


def scores_of(ways: Sequence[str]) -> dict[str, list[TrialScore]]:
    """Return the scores of the trials played in some ways, by task."""
    scenario = scenario_of(COLIN27)
    found: dict[str, list[TrialScore]] = {task: [] for task in TASKS}
    for one in stored():
        if one.way in ways:
            found[one.task].append(score_trial(one.measures, score_reference(scenario, one.task)))
    return found


def played(_sets: int) -> list[Scored]:
    """Return the scores of each strategy."""
    return [Scored(words, scores_of(ways), most) for words, ways, most in ROWS]


ABORTED_HEADER = (
    "trainee, 30 trials started",
    "called competent",
    "aborted trials not counted (previous method)",
    "not counted, until 30 are finished (previous method)",
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
    counted, uncounted, until_finished, finished = [], [], [], []
    for _ in range(sets):
        # Enough for 30 finished trials, however many are aborted.
        failed = random.random(20 * TRIALS) >= passing
        aborted = failed & (random.random(len(failed)) < aborting)
        counted.append(_is_competent(failed[:TRIALS]))
        uncounted.append(_is_competent(failed[:TRIALS][~aborted[:TRIALS]]))
        until_finished.append(_is_competent(failed[~aborted][:TRIALS]))
        finished.append(int(np.sum(~aborted[:TRIALS])))
    further = (
        *(f"{fixed(100 * share_of(each), 1)} %" for each in (uncounted, until_finished)),
        fixed(float(np.mean(finished)), 1),
    )
    return Measured(case, share_of(counted), sets, at_most, at_least, further)


def _is_competent(failed: np.ndarray) -> bool:
    return competence_of([bool(each) for each in failed]).competent_at is not None


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
        rates, by_sd = [], []
        for _ in range(sets):
            ours, standard = _throughputs(offset, random)
            rates.append(ours)
            by_sd.append(standard)
        further = fixed(float(np.mean(rates)), 2), fixed(float(np.mean(by_sd)), 2)
        above = share_of(np.array(rates) > 8)
        limit = 0.0 if offset else None
        found.append(Measured(f"{offset:g} mm", above, sets, at_most=limit, further=further))
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
