"""Whether the same hands get equal scores on every task of three heads.

Time, contacts and every touch were played. A single score scatters by some ten points, mostly
because of how fifteen errors happen to add up, so that the mean of a dozen says little about two
points. So the scored trials are put together: each touch has the error of a played touch, turned
randomly about the skin's normal, and each trial has the time of one of the task's trials.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rastrainer.number_text import fixed, signed
from rastrainer.trial.score_reference import fiducial_normals, region_of, score_reference
from rastrainer.trial.scoring import ScoreMeasures, score_trial
from rastrainer_simulator.statistics.intervals import rms
from Testing.error_rates.hands import HEADS, SLOW, TASKS, USUAL, HandsTrial, scenario_of, trials_of
from Testing.error_rates.measured import Measured
from Testing.error_rates.registered import common_biases, registered_errors

MAX_OFF = 2.0
"""Points by which a task's mean score may differ from the mean of all tasks."""
MAX_OFF_TRIAL_RUN = 4.0
"""Same for a trial run, which nobody passes or fails: its fiducials are on a small patch."""
MORE = 4
"""Factor of sets for the required deviation."""
RESAMPLES = 25
"""Parts of the played trials, each with a quarter of the sets, for a standard error."""
HEADER = (
    "task",
    "deviation, points",
    "standard error",
    "score",
    "deviation of all that was played",
    "standard error",
    "n",
    "played time, s",
    "reference, s",
    "true TRE, RMS, mm",
    "reference, mm",
    "square root of safety",
)


def usual(sets: int) -> list[Measured]:
    """Return the usual hands' scores, with `sets` trials put together for each task."""
    return scores(USUAL, sets)


def slow(sets: int) -> list[Measured]:
    """Return the scores of slower, less accurate hands."""
    return scores(SLOW, sets)


def scores(hands: str, sets: int, seed: int = 22) -> list[Measured]:
    """Return how far each task's mean score, on every head, is from the mean of all tasks.

    A first score has touches of all tasks and times of this task, without contacts; a second has
    touches, times and contacts of this task alone. If sets are few, a point more is allowed.
    """
    tasks = [
        PlayedTask(head, task, trials_of(hands, head, task)) for head in HEADS for task in TASKS
    ]
    touches = np.concatenate([task.touches for task in tasks])
    found = [
        _mean_scores(task, touches, sets, np.random.default_rng([seed, number]))
        for number, task in enumerate(tasks)
    ]
    equal, own = (np.mean([one[at][0] for one in found]) for at in (0, 1))
    rows = []
    for task, ((score, error), (own_score, own_error), tre_mm) in zip(tasks, found, strict=True):
        safety = [score_trial(one, task.reference).safety_desirability for one in task.played()]
        further = (
            *(fixed(error, 1), fixed(score, 1), signed(own_score - own, 1), fixed(own_error, 1)),
            str(len(task.trials)),
            fixed(float(np.mean([one.time_s for one in task.trials])), 1),
            fixed(task.reference.time_s, 1),
            *(fixed(tre_mm, 2), fixed(task.reference.tre_mm, 2)),
            fixed(float(np.mean(np.sqrt(safety))), 3),
        )
        rows.append(
            Measured(
                f"{task.head}, {task.name}",
                abs(score - equal),
                at_most=MAX_OFF_TRIAL_RUN if task.name == TASKS[0] else MAX_OFF,
                further=further,
                is_share=False,
                slack=lambda standard_errors: float(standard_errors > 0),
            )
        )
    return rows


def _mean_scores(
    task: PlayedTask, touches: np.ndarray, sets: int, random: np.random.Generator
) -> tuple[tuple[float, float], tuple[float, float], float]:
    """Return both mean scores with their standard errors, and the RMS of the true TRE, mm."""
    count = len(task.trials)
    measures = task.assemble(touches, MORE * sets, random)
    points = task.scores([_gentle(one) for one in measures])
    of_each = [points[number::count].mean() for number in range(count)]
    own = task.scores(task.assemble(task.touches, sets, random))
    means = []
    for _ in range(RESAMPLES):
        again = [task.trials[number] for number in random.integers(0, count, count)]
        other = PlayedTask(task.head, task.name, again)
        means.append(other.scores(other.assemble(other.touches, sets // 4, random)).mean())
    # Fewer sets add variance.
    variance = max(np.var(means, ddof=1) - 3 * np.var(own) / sets, 0.0)
    return (
        (float(points.mean()), float(np.std(of_each, ddof=1) / np.sqrt(count))),
        (float(own.mean()), float(np.sqrt(variance))),
        rms([one.tre_mm for one in measures]),
    )


class PlayedTask:
    """The trials that some hands have played on a task, and trials put together from played parts.

    `touches` are their errors in frames of the skin, (15 × trials, 3) float, mm.
    """

    def __init__(self, head: str, name: str, trials: Sequence[HandsTrial]) -> None:
        scenario = scenario_of(head)
        self.head, self.name, self.trials = head, name, trials
        self.touches = errors_on_skin(head, name, trials)
        self.reference = score_reference(scenario, name)
        self._region = region_of(scenario)
        self._fiducials = np.asarray(scenario.task(name).fiducials, dtype=float)
        self._normals = fiducial_normals(scenario, name)

    def assemble(
        self, touches: np.ndarray, sets: int, random: np.random.Generator
    ) -> list[ScoreMeasures]:
        """Return the measures of `sets` trials with the errors of `touches`, (k, 3), skin, mm."""
        shape = (sets, len(self._fiducials))
        chosen = touches[random.integers(0, len(touches), shape)]
        along = chosen[..., 0] + 1j * chosen[..., 1]
        along = along * np.exp(2j * np.pi * random.random(shape))
        turned = np.stack([along.real, along.imag, chosen[..., 2]], axis=-1)
        errors = np.einsum("iaj,sia->sij", _frames(self._normals), turned)
        return self._of([self.trials[i % len(self.trials)] for i in range(sets)], errors)

    def played(self) -> list[ScoreMeasures]:
        """Return the measures of the trials as they were played."""
        return self._of(self.trials, np.array([one.errors_mm for one in self.trials]))

    def scores(self, measures: Sequence[ScoreMeasures]) -> np.ndarray:
        """Return the scores of trials of this task, (n,) float."""
        return np.array([score_trial(one, self.reference).score for one in measures])

    def _of(self, trials: Sequence[HandsTrial], errors: np.ndarray) -> list[ScoreMeasures]:
        tres = registered_errors(self._region, self._fiducials, self._fiducials + errors)
        biases = common_biases(self._normals, errors)
        return [
            ScoreMeasures(trial.time_s, float(tre), *trial.safety, float(bias))
            for trial, tre, bias in zip(trials, tres, biases, strict=True)
        ]


def errors_on_skin(head: str, task: str, trials: Sequence[HandsTrial]) -> np.ndarray:
    """Return the errors of touches, (15 × trials, 3) float, mm: along the skin (2), and off it."""
    frames = _frames(fiducial_normals(scenario_of(head), task))
    errors = np.array([one.errors_mm for one in trials])
    return np.einsum("iaj,sij->sia", frames, errors).reshape(-1, 3)


def _gentle(measures: ScoreMeasures) -> ScoreMeasures:
    """Return the measures of a trial without any contact."""
    return replace(measures, contact_time_s=0.0, contact_path_mm=0.0, pressing_depth_mm=0.0)


def _frames(normals: np.ndarray) -> np.ndarray:
    """Return frames of the skin, (n, 3, 3) float: two directions along it, and its normal."""
    return np.array([_frame(normal) for normal in normals])


def _frame(normal: np.ndarray) -> np.ndarray:
    along = np.eye(3)[np.abs(normal).argmin()]
    first = np.cross(normal, along)
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(normal, first), normal])
