"""Whether equal skill gets equal scores on every task of three heads."""

from __future__ import annotations

import functools
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rastrainer.number_text import fixed
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.score_reference import fiducial_normals, region_of, score_reference
from rastrainer.trial.scoring import ScoreMeasures, ScoreReference, score_trial
from rastrainer_simulator.core.setup import SimulationSetup
from Testing.error_rates.played import HEADS, SLOW, TASKS, USUAL, stored
from Testing.error_rates.registered import common_biases, errors_along_skin, registered_errors
from Testing.simulator.authoring.planned_heads import setup_of

MOST_OFF = 2.0
"""Points by which a task's mean score may be off that of all tasks."""
MOST_OFF_SLOW = 3.0
"""The same of hands that the references were not made for, played once a task."""
FLE_MM = {USUAL: 1.0, SLOW: 1.7}
HEADER = (
    "task",
    "deviation, points",
    "score",
    "played time, s",
    "reference, s",
    "true TRE, RMS, mm",
    "reference, mm",
    "square root of safety",
)


@dataclass(frozen=True)
class EqualScore:
    """The mean score of equal skill on one task, and its deviation from that on all tasks."""

    case: str
    off: float
    score: float
    time_s: float
    tre_mm: float
    safety: float
    reference: ScoreReference
    at_most: float | None
    at_least: None = None

    def holds(self, standard_errors: float = 0.0) -> bool:
        """Return whether the deviation is within the limit, or a point more with few sets."""
        return self.at_most is None or abs(self.off) <= self.at_most + (standard_errors > 0)

    def cells(self) -> list[str]:
        """Return the row of a table."""
        reference = self.reference
        return [
            self.case,
            fixed(abs(self.off), 1),
            "–" if self.at_most is None else f"≤ {self.at_most:g}",
            fixed(self.score, 1),
            fixed(self.time_s, 1),
            fixed(reference.time_s, 1),
            fixed(self.tre_mm, 2),
            fixed(reference.tre_mm, 2),
            fixed(self.safety, 3),
        ]


def usual(sets: int) -> list[EqualScore]:
    """Return the usual hands' scores, with `sets` registrations per task."""
    return scores(USUAL, sets, MOST_OFF)


def slow(sets: int) -> list[EqualScore]:
    """Return the scores of slower, less accurate hands."""
    return scores(SLOW, sets, MOST_OFF_SLOW)


def scores(way: str, sets: int, at_most: float | None, seed: int = 22) -> list[EqualScore]:
    """Return the mean scores of equal skill on every task of every head."""
    random = np.random.default_rng(seed)
    found = []
    for head, task in ((head, task) for head in HEADS for task in TASKS):
        scenario = scenario_of(head)
        trials = [
            one.measures for one in stored() if (one.head, one.way, one.task) == (head, way, task)
        ]
        if not trials:
            continue
        reference = score_reference(scenario, task)
        tre_mm, bias_mm = true_errors(scenario, task, FLE_MM[way], sets, random)
        times_s = [one.completion_time_s for one in trials]
        # Half of the score is time and half accuracy: each mean is taken over all that there is.
        gentle = [
            score_trial(
                ScoreMeasures(times_s[number % len(times_s)], tre, 0.0, 0.0, 0.0, bias), reference
            ).score
            for number, (tre, bias) in enumerate(zip(tre_mm, bias_mm, strict=True))
        ]
        safety = [np.sqrt(score_trial(one, reference).safety_desirability) for one in trials]
        rms = float(np.sqrt(np.mean(tre_mm**2)))
        found.append(
            (
                f"{head}, {task}",
                float(np.mean(gentle)),
                float(np.mean(times_s)),
                rms,
                float(np.mean(safety)),
                reference,
            )
        )
    whole = float(np.mean([score for _, score, *_ in found]))
    return [
        EqualScore(case, score - whole, score, *others, at_most) for case, score, *others in found
    ]


def true_errors(
    scenario: Scenario, task: str, fle_mm: float, sets: int, random: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Return the true errors over the region, (sets,) mm, of registered touches, and their biases.

    The errors of the touches are along the skin, of RMS length `fle_mm`; their common biases are
    (sets,) mm.
    """
    fiducials = np.asarray(scenario.task(task).fiducials, dtype=float)
    normals = fiducial_normals(scenario, task)
    errors = errors_along_skin(normals, fle_mm, sets, random)
    tre_mm = registered_errors(region_of(scenario), fiducials, fiducials + errors)
    return tre_mm, common_biases(normals, errors)


def scenario_of(head: str) -> Scenario:
    """Return the scenario of one of the three heads."""
    return setup(head).scenario


@functools.cache
def setup(head: str) -> SimulationSetup:
    """Return the setup of one of the three heads; its files remain until the program ends."""
    return setup_of(head, Path(_folder().name))


@functools.cache
def _folder() -> tempfile.TemporaryDirectory:
    return tempfile.TemporaryDirectory()
