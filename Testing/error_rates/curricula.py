"""How often a curriculum calls a goal reached, and how well it chooses what to practice next."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from statistics import fmean

import numpy as np

from rastrainer.number_text import fixed
from rastrainer.protocol import AssignmentState, GoalKind
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.standing import (
    AssignmentStanding,
    CurriculumStanding,
    standing_in,
)
from rastrainer.study_messages import Assignment
from rastrainer.trial.scoring import PASS_MARK
from rastrainer.trial.trial_row import TrialRow
from Testing.error_rates.measured import Measured, share_of

GOALS_HEADER = ("goal, and trainee", "called reached")
CHOICES_HEADER = (
    "what is practiced next",
    "all reached within 40 trials",
    "trials until all are reached, mean",
    "weakest task after 20 trials, points",
)
TASKS = 5
MOST_TRIALS = 120
DAY = 10
"""Trials on a day, which is good or bad by chance."""
START, TASK_SD, TRAINEE_SD, TRIAL_SD, CEILING = 52.0, 12.0, 6.0, 8.0, 88.0
LEARNING, TRANSFER = 0.12, 0.03
"""Share of the way to the ceiling that a trial adds to its task, and to each other task."""
CURRICULUM = Curriculum(
    "c",
    "C",
    tuple(Assignment(str(task), f"task-{task}", trials=3) for task in range(1, TASKS + 1)),
)


def goals(sets: int) -> list[Measured]:
    """Return how often trainees who fail as often, and learn nothing, reach each goal.

    In the last rows, their failure rate changes from day to day, and is as high on average.
    """
    rows = [(Assignment("one", "task-1", trials=1), "1 trial")]
    rows += [(Assignment("one", "task-1", trials=n), f"{n} in a row") for n in (2, 3, 5)]
    competent = Assignment("one", "task-1", goal=GoalKind.COMPETENT, trials=0)
    rows.append((competent, "LC-CUSUM"))
    found = []
    for number, (assignment, what) in enumerate(rows):
        for failing, trials in itertools.product((0.4, 0.05), (10, 30, 60)):
            random = np.random.default_rng((5, number, trials, round(100 * failing)))
            rates = np.full((sets, trials), failing)
            reached = share_of([_is_reached(assignment, own, random) for own in rates])
            case = f"{what}, fails in {100 * failing:.0f} of 100, {trials} trials"
            limits: dict[str, float] = {}
            if assignment is competent and trials == 30:
                limits = {"at_most": 0.06} if failing > 0.1 else {"at_least": 0.8}
            found.append(Measured(case, reached, sets, **limits))
    for apart in (0.1, 0.2, 0.3):
        random = np.random.default_rng((5, 9, round(100 * apart)))
        days = 0.4 + apart * random.choice([-1.0, 1.0], (sets, 3))
        reached = [_is_reached(competent, own, random) for own in np.repeat(days, DAY, axis=1)]
        good, bad = (f"{100 * (0.4 + way * apart):.0f}" for way in (-1, 1))
        days_of = f"LC-CUSUM, fails in {good} of 100 on good days and {bad} on bad ones"
        found.append(Measured(f"{days_of}, {3 * DAY} trials", share_of(reached), sets))
    return found


def _is_reached(assignment: Assignment, failing: np.ndarray, random: np.random.Generator) -> bool:
    """Return whether trials (n,) that fail with these probabilities reach the goal."""
    passed = random.random(len(failing)) >= failing
    played = [_trial("task-1", 80.0 if each else 40.0) for each in passed]
    return _stand(Curriculum("c", "C", (assignment,)), played).reached == 1


def _trial(task: str, score: float) -> TrialRow:
    return TrialRow("", "desktop", task, values={"score": score}, acceptable=True)


def _stand(curriculum: Curriculum, trials: Sequence[TrialRow]) -> CurriculumStanding:
    return standing_in(curriculum, trials, lambda _version: PASS_MARK)


Choice = Callable[[CurriculumStanding, np.random.Generator], AssignmentStanding]


def _open(standing: CurriculumStanding) -> list[AssignmentStanding]:
    return [each for each in standing.standings if each.state is AssignmentState.OPEN]


def next_best(standing: CurriculumStanding, _random: np.random.Generator) -> AssignmentStanding:
    """Choose as the product does."""
    return standing.next_best


def in_rotation(standing: CurriculumStanding, _random: np.random.Generator) -> AssignmentStanding:
    """Choose the task that was played least."""
    return min(_open(standing), key=lambda each: each.played)


CHOICES: dict[str, Choice] = {
    "next best task": next_best,
    "by turns": in_rotation,
    "at random": lambda standing, random: (is_open := _open(standing))[
        random.integers(len(is_open))
    ],
    "in order, each until it is reached": lambda standing, _random: _open(standing)[0],
}


def course(choose: Choice, seed: int) -> tuple[int, float]:
    """Return the course of a learner with their own weak tasks.

    It is the number of trials until all goals are reached, or `MOST_TRIALS`, and the true mean
    score of the weakest task after 20 trials.
    """
    random = np.random.default_rng((6, seed))
    skill = _skill(random)
    played: list[TrialRow] = []
    after_some = float(skill.min())
    while len(played) < MOST_TRIALS:
        standing = _stand(CURRICULUM, played)
        if standing.reached == TASKS:
            break
        chosen = int(choose(standing, random).name) - 1
        played.append(_play(chosen, skill, random))
        gain = np.full(TASKS, TRANSFER)
        gain[chosen] = LEARNING
        skill = skill + gain * (CEILING - skill)
        if len(played) <= 20:
            after_some = float(skill.min())
    return len(played), after_some


def choices(sets: int) -> list[Measured]:
    """Return how well each strategy of choosing does with the same learners."""
    found = []
    for name, choose in CHOICES.items():
        courses = [course(choose, seed) for seed in range(sets)]
        within = share_of([trials <= 40 for trials, _weakest in courses])
        further = tuple(fixed(fmean(each), 1) for each in zip(*courses, strict=True))
        asked = 0.8 if choose is next_best else None
        found.append(Measured(name, within, sets, at_least=asked, further=further))
    return found


def _skill(random: np.random.Generator) -> np.ndarray:
    """Return a learner's true mean score in each task."""
    return START + random.normal(0, TRAINEE_SD) + random.normal(0, TASK_SD, TASKS)


def _play(task: int, skill: np.ndarray, random: np.random.Generator) -> TrialRow:
    score = float(np.clip(random.normal(skill[task], TRIAL_SD), 1.0, 100.0))
    return _trial(f"task-{task + 1}", score)
