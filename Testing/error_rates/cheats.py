"""What cheating pays: the scores of trials that were played honestly and otherwise."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.number_text import fixed
from rastrainer.trial.score_reference import score_reference
from rastrainer.trial.scoring import PASS_MARK, TrialScore, passes, score_trial
from rastrainer.trial.trainee_progress import TRAINING_TRIALS, competence_of
from rastrainer_simulator.core.setup import load_setup
from Testing.error_rates.played import TASKS, stored

MOST = 40.0
"""Points that a cheat may get."""
HEADER = ("strategy", "highest score", "passed", f"competent after {TRAINING_TRIALS}", *TASKS)
FIVE = TASKS[1:]
ROWS: tuple[tuple[str, str, Sequence[str], float | None], ...] = (
    ("honest, FLE 1 mm", "honest", TASKS, None),
    ("hover with an offset of 9 mm, the paper's touch rule", "hover", TASKS, MOST),
    ("hover with an offset of 2 mm, the paper's touch rule", "hover 2 mm", TASKS, MOST),
    ("aim 2 mm off along the skin, Tasks 1 to 5", "aim beside", FIVE, MOST),
    ("the same, trial run", "aim beside", TASKS[:1], PASS_MARK),
    ("drag from fiducial to fiducial", "drag", TASKS, MOST),
    ("press 2 mm into the head", "press", TASKS, MOST),
    ("aim 2 mm off along x, to the front", "aim beside, x", TASKS, None),
    ("aim 2 mm off along y, to the left", "aim beside, y", TASKS, None),
    ("aim 2 mm off along z, upward", "aim beside, z", TASKS, None),
)


@dataclass(frozen=True)
class Scored:
    """The scores of one way to play.

    Attributes:
        case: the way, in words.
        scores: of each trial, by task.
        at_most: what none may exceed; None where it is only told.
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
        """At which of thirty trials LC-CUSUM calls the trainee competent.

        The trials are those that were played, over and over.
        """
        failures = [not _passes(one) for one in self._all()]
        return competence_of(
            [*itertools.islice(itertools.cycle(failures), TRAINING_TRIALS)]
        ).competent_at

    def holds(self, standard_errors: float = 0.0) -> bool:  # noqa: ARG002
        """Return whether no trial is above what is asked, and none passes."""
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


def scores_of(way: str, tasks: Sequence[str] = TASKS) -> dict[str, list[TrialScore]]:
    """Return the scores of the trials on Colin27 that were played in a way, by task."""
    scenario = load_setup().scenario
    found: dict[str, list[TrialScore]] = {task: [] for task in tasks}
    for one in stored():
        if (one.head, one.way) == ("colin27", way) and one.task in found:
            found[one.task].append(score_trial(one.measures, score_reference(scenario, one.task)))
    return found


def played(_sets: int) -> list[Scored]:
    """Return what each way to play was worth."""
    return [Scored(words, scores_of(way, tasks), most) for words, way, tasks, most in ROWS]
