"""The gain of missing every fiducial in one direction, by simulated registrations.

Playing one trial takes seconds, and chance may hide what a direction pays. So the errors of the
touches are drawn here: errors of honest hands, and a common bias that the skin leaves of 2 mm in
one of many directions. Time and safety come from the stored trials of the usual hands.
"""

from __future__ import annotations

import itertools

import numpy as np

from rastrainer.number_text import fixed
from rastrainer.trial.score_reference import fiducial_normals, region_of, score_reference
from rastrainer.trial.scoring import PASS_MARK, ScoreMeasures, passes, score_trial
from Testing.error_rates.cheats import MOST
from Testing.error_rates.hands import HEADS, TASKS, USUAL, scenario_of, trials_of
from Testing.error_rates.measured import Measured, share_of, share_text
from Testing.error_rates.registered import common_biases, errors_along_skin, registered_errors
from Testing.simulator.virtual.cheating_trainees import BIAS_MM, FLE_MM
from Testing.sphere_directions import sphere_directions

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


def scores(sets: int, seed: int = 31) -> list[Measured]:
    """Return the scores on every task of every head, from `sets` trials in each direction."""
    random = np.random.default_rng(seed)
    return [_on_task(head, task, sets, random) for head in HEADS for task in TASKS]


def _on_task(head: str, task: str, sets: int, random: np.random.Generator) -> Measured:
    normals = fiducial_normals(scenario_of(head), task)
    honest, honest_passed = scored(head, task, errors_along_skin(normals, FLE_MM, sets, random))
    found, passed = [], []
    for direction in sphere_directions(DIRECTIONS):
        bias = BIAS_MM * (direction - normals * (normals @ direction)[:, None])
        errors = errors_along_skin(normals, FLE_MM, sets, random) + bias
        for kept, value in zip((found, passed), scored(head, task, errors), strict=True):
            kept.append(value)
    points = np.array(found)
    above, share_passed = np.mean(points > MOST, axis=1), float(np.mean(passed))
    return Measured(
        f"{head}, {task}",
        float(above.max()),
        sets,
        at_most=MAX_ABOVE,
        further=(
            share_text(share_passed),
            share_text(float(above.mean())),
            fixed(float(points.mean(axis=1).max()), 1),
            fixed(float(np.quantile(points, 0.95, axis=1).max()), 1),
            fixed(float(honest.mean()), 1),
            share_text(honest_passed, 0),
        ),
        also=lambda _standard_errors: share_passed == 0.0,
    )


def scored(head: str, task: str, errors: np.ndarray) -> tuple[np.ndarray, float]:
    """Return the scores, (sets,) float, of trials, and the share that passes.

    The errors of touches are (sets, n, 3) float, RAS, mm.
    """
    scenario, normals = scenario_of(head), fiducial_normals(scenario_of(head), task)
    fiducials = np.asarray(scenario.task(task).fiducials, dtype=float)
    tre_mm = registered_errors(region_of(scenario), fiducials, fiducials + errors)
    bias_mm = common_biases(normals, errors)
    reference, hands = score_reference(scenario, task), trials_of(USUAL, head, task)
    found = []
    for one, tre, bias in zip(itertools.cycle(hands), tre_mm, bias_mm, strict=False):
        measures = ScoreMeasures(one.time_s, float(tre), *one.safety, float(bias))
        found.append(score_trial(measures, reference))
    passed = share_of([passes(one.score, one.acceptable, PASS_MARK) for one in found])
    return np.array([one.score for one in found]), passed
