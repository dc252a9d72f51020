"""The gain of missing every fiducial in one direction, by simulated registrations.

Playing one trial takes seconds, and chance may hide what a direction pays. So the errors of the
touches are drawn here: errors of honest hands, and a common bias that the skin leaves of 2 mm in
one of many directions. Time and safety come from the stored trials of the usual hands.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.number_text import fixed
from rastrainer.trial.score_reference import fiducial_normals, region_of, score_reference
from rastrainer.trial.scoring import PASS_MARK, ScoreMeasures, passes, score_trial
from rastrainer_simulator.collision.robot_shape import sphere_directions
from Testing.error_rates.cheats import MOST
from Testing.error_rates.hands import HEADS, TASKS, USUAL, scenario_of, trials_of
from Testing.error_rates.measured import share_of, share_text
from Testing.error_rates.registered import common_biases, errors_along_skin, registered_errors
from Testing.simulator.virtual.cheating_trainees import BIAS_MM, FLE_MM

DIRECTIONS = 60
MAX_ABOVE = 0.02
"""Requirements for the trials in the direction that pays most."""
HEADER = (
    "task",
    "trials above 40, best direction",
    "passed, all directions",
    "above 40, all directions",
    "mean score, best direction",
    "95 % quantile",
    "honest mean score",
    "honest trials passed",
)


@dataclass(frozen=True)
class BiasedAim:
    """The scores of one task with a bias in many directions, and of honest touches.

    Attributes:
        case: head and task.
        scores: (directions, sets) float, each with a bias.
        passed: share of these that pass.
        honest: (sets,) float.
        honest_passed: share of these that pass.
    """

    case: str
    scores: np.ndarray
    passed: float
    honest: np.ndarray
    honest_passed: float
    at_most: float = MAX_ABOVE
    at_least: None = None

    @property
    def above(self) -> np.ndarray:
        """The share of the trials with more than 40 points in each direction."""
        return np.mean(self.scores > MOST, axis=1)

    def holds(self, standard_errors: float = 0.0) -> bool:
        """Return whether no trial passes and few are above 40 points."""
        slack = standard_errors * np.sqrt(self.at_most / self.scores.shape[1])
        return self.passed == 0.0 and float(self.above.max()) <= self.at_most + slack

    def cells(self) -> list[str]:
        """Return the row of a table."""
        means = self.scores.mean(axis=1)
        return [
            self.case,
            share_text(float(self.above.max())),
            f"≤ {share_text(self.at_most, 0)}",
            share_text(self.passed),
            share_text(float(self.above.mean())),
            fixed(float(means.max()), 1),
            fixed(float(np.quantile(self.scores, 0.95, axis=1).max()), 1),
            fixed(float(self.honest.mean()), 1),
            share_text(self.honest_passed, 0),
        ]


def scores(sets: int, seed: int = 31) -> list[BiasedAim]:
    """Return the scores on every task of every head, from `sets` trials in each direction."""
    random = np.random.default_rng(seed)
    return [_on_task(head, task, sets, random) for head in HEADS for task in TASKS]


def _on_task(head: str, task: str, sets: int, random: np.random.Generator) -> BiasedAim:
    normals = fiducial_normals(scenario_of(head), task)
    honest, honest_passed = scored(head, task, errors_along_skin(normals, FLE_MM, sets, random))
    found, passed = [], []
    for direction in sphere_directions(DIRECTIONS):
        bias = BIAS_MM * (direction - normals * (normals @ direction)[:, None])
        errors = errors_along_skin(normals, FLE_MM, sets, random) + bias
        points, share = scored(head, task, errors)
        found.append(points)
        passed.append(share)
    return BiasedAim(
        f"{head}, {task}", np.array(found), float(np.mean(passed)), honest, honest_passed
    )


def scored(head: str, task: str, errors: np.ndarray) -> tuple[np.ndarray, float]:
    """Return the scores, (sets,) float, of trials, and the share that passes.

    Args:
        head: one of `HEADS`.
        task: of the head.
        errors: (sets, n, 3) float, of the touches, RAS mm.
    """
    scenario, normals = scenario_of(head), fiducial_normals(scenario_of(head), task)
    fiducials = np.asarray(scenario.task(task).fiducials, dtype=float)
    tre_mm = registered_errors(region_of(scenario), fiducials, fiducials + errors)
    bias_mm = common_biases(normals, errors)
    reference, hands = score_reference(scenario, task), trials_of(USUAL, head, task)
    found = [
        score_trial(
            ScoreMeasures(
                hands[number % len(hands)].time_s,
                float(tre),
                *hands[number % len(hands)].safety,
                float(bias),
            ),
            reference,
        )
        for number, (tre, bias) in enumerate(zip(tre_mm, bias_mm, strict=True))
    ]
    passed = share_of([passes(one.score, one.acceptable, PASS_MARK) for one in found])
    return np.array([one.score for one in found]), passed
