"""RASTrainer's own score of a trial: 0 to 100, from completion time and expected target error.

The score is the geometric mean of two desirabilities (Harrington 1965, Derringer and Suich 1980),
each strictly falling: faster is better, more accurate is better. An error beyond the limit of
acceptance is cut so far that even the fastest such trial stays below every acceptable one. The
references are fixed per task before anyone trains, and the mode plays no part.

A pause is no completion time: the arm stands still, and a trainee who is called away shall not lose
for it. But it is time to think that is not scored. So its length stands beside the score, and
pauses longer in all than `LONG_PAUSE_S` are told with it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rastrainer.errors import InputError
from rastrainer.protocol import TRIAL_RUN

SCORE_VERSION = "1"
"""Changes with any change of a formula or reference, so that scores stay comparable."""
PASS_MARK = 70.0
"""Score to reach where a study's protocol has no mark of its own from contrasting groups."""
LONG_PAUSE_S = 30.0
"""Our own convention: what a sip of water or a word with the instructor takes."""
TIME_FLOOR = 0.04
TIME_LIMIT_S = 1e6
ERROR_LIMIT_MM = 1e6


@dataclass(frozen=True)
class ScoreReference:
    """What a score is measured against.

    Attributes:
        time_s: Completion time of half the range of the time desirability.
        tre_mm: Expected target error of accuracy desirability one half.
        limit_mm: Largest acceptable expected target error.
    """

    time_s: float
    tre_mm: float = 0.4
    limit_mm: float = 2.0


# Times: pooled means of both modes of the published study, rounded to 5 s; the trial run is a
# little easier than Task 1. Error: what the study's mean RMSE of 1.4 mm over fifteen fiducials
# means at the center of the head. Limit: the 2 mm that image-guided neurosurgery asks for.
TASK_REFERENCES = {
    TRIAL_RUN: ScoreReference(100.0),
    "task-1": ScoreReference(105.0),
    "task-2": ScoreReference(125.0),
    "task-3": ScoreReference(130.0),
    "task-4": ScoreReference(135.0),
    "task-5": ScoreReference(140.0),
}


@dataclass(frozen=True)
class TrialScore:
    """The score of one trial and its parts.

    Attributes:
        score: Above 0 up to 100; about 51 for a trial at both references.
        time_desirability: From `TIME_FLOOR` (never done) to 1 (at once).
        accuracy_desirability: From 0 (no registration) to 1 (no error).
        acceptable: Whether the expected target error is within the limit.
        completion_time_s: The time that was scored, in s.
        expected_tre_mm: The error that was scored, in mm.
        reference: What they were measured against.
        version: Version of the formula and the shipped references.
    """

    score: float
    time_desirability: float
    accuracy_desirability: float
    acceptable: bool
    completion_time_s: float
    expected_tre_mm: float
    reference: ScoreReference
    version: str = SCORE_VERSION

    def to_json(self) -> dict[str, Any]:
        """Return the score as a JSON object."""
        return {
            "score": self.score,
            "time_desirability": self.time_desirability,
            "accuracy_desirability": self.accuracy_desirability,
            "acceptable": self.acceptable,
            "completion_time_s": self.completion_time_s,
            "expected_tre_mm": self.expected_tre_mm,
            "reference_time_s": self.reference.time_s,
            "reference_tre_mm": self.reference.tre_mm,
            "limit_mm": self.reference.limit_mm,
            "version": self.version,
        }

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> TrialScore:
        """Return the score that `to_json` described."""
        return cls(
            score=value["score"],
            time_desirability=value["time_desirability"],
            accuracy_desirability=value["accuracy_desirability"],
            acceptable=value["acceptable"],
            completion_time_s=value["completion_time_s"],
            expected_tre_mm=value["expected_tre_mm"],
            reference=ScoreReference(
                value["reference_time_s"], value["reference_tre_mm"], value["limit_mm"]
            ),
            version=value["version"],
        )


def task_reference(task: str) -> ScoreReference:
    """Return the fixed reference of a shipped task.

    Raises:
        InputError: the task has none; the sentence lists those that have.
    """
    try:
        return TASK_REFERENCES[task]
    except KeyError:
        known = ", ".join(TASK_REFERENCES)
        raise InputError(
            f"The task {task!r} has no reference for scoring; those that have are {known}."
        ) from None


def passes(score: float, acceptable: bool, pass_mark: float) -> bool:
    """Tell whether a trial reaches the mark with an acceptable expected target error."""
    return acceptable and score >= pass_mark


def score_trial(
    completion_time_s: float, expected_tre_mm: float, reference: ScoreReference
) -> TrialScore:
    """Return the score of a trial.

    Args:
        completion_time_s: Above 0, in s.
        expected_tre_mm: Expected error at the scenario's target, not below 0, in mm.
        reference: Of the trial's task.

    Raises:
        InputError: the time or the error is no such number.
    """
    if not 0 < completion_time_s <= TIME_LIMIT_S:
        raise InputError("The completion time must be a number of seconds above 0.")
    if not 0 <= expected_tre_mm <= ERROR_LIMIT_MM:
        raise InputError("The expected target error must be a number of mm, 0 or above.")
    time = TIME_FLOOR + (1 - TIME_FLOOR) * _falling(completion_time_s, reference.time_s)
    accuracy = _falling(expected_tre_mm, reference.tre_mm)
    acceptable = expected_tre_mm <= reference.limit_mm
    if not acceptable:
        # The cut equals the whole range of the time desirability: speed cannot make up for it.
        accuracy *= TIME_FLOOR
    return TrialScore(
        score=100 * math.sqrt(time * accuracy),
        time_desirability=time,
        accuracy_desirability=accuracy,
        acceptable=acceptable,
        completion_time_s=completion_time_s,
        expected_tre_mm=expected_tre_mm,
        reference=reference,
    )


def _falling(value: float, half: float) -> float:
    """Return 1/(1 + (value/half)²): 1 at 0, ½ at `half`; strictly falling without saturating."""
    return 1 / (1 + (value / half) ** 2)
