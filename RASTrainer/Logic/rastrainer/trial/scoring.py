"""RASTrainer's score of a trial: 0 to 100, from completion time, true errors and safety.

Each is a strictly decreasing desirability (Harrington 1965, Derringer and Suich 1980): faster, more
accurate and gentler are better. The score is the geometric mean of time and accuracy, times the
square root of safety, which is 1 without unintended contact. Exceeding a limit reduces the score so
far that no such trial reaches any acceptable one.

Accuracy is the true error over the region in which the registration has to be right
(`rastrainer.trial.score_reference`), times the trueness of the touches: the bias that all of them
share (`rastrainer.registration.target_error`). Only a simulator knows either; neither FRE nor
expected TRE can detect a common bias. The references come from the scenario and do not depend on
the mode.

Pauses are not part of the completion time: the arm is still, and interruptions should not cost
points. But they give time to think, so pauses longer in total than `LONG_PAUSE_S` are reported with
the score.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from rastrainer.errors import InputError
from rastrainer.json_checks import number
from rastrainer.protocol import RegistrationMethod

TIME_FLOOR = 0.04
"""Desirability of an infinite time: being slow never costs as much as being wrong."""
SCORE_VERSION = "1"
"""Changes with any change of a formula or a reference, so that scores stay comparable."""
PASS_MARK = 70.0
"""Score to reach if a study's protocol has no mark from contrasting groups."""
LONG_PAUSE_S = 30.0
"""Our own convention: what a sip of water or a word with the instructor takes."""
LIMIT_MM = 1.5
"""Largest acceptable true TRE. Image-guided neurosurgery asks for 2 mm in all, of which the images,
the robot and its instrument take the rest: √(2² − 1.5²) = 1.3 mm."""
HALF_COMMON_BIAS_MM, COMMON_BIAS_LIMIT_MM = 1.0, 1.5
COMMON_BIAS_POWER = 4
"""Steeper than the others: touches that scatter by 1 mm seem to share 0.4 mm, which should cost
little, and a true bias of 2 mm much. Half, power and limit are our own convention."""
HALF_CONTACT_S, CONTACT_LIMIT_S = 4.0, 8.0
"""Unintended contact in a trial that halves the desirability, and the most that is acceptable: a
brush of a second now and then, not the tool's usual travel. Our own convention, as the next."""
HALF_CONTACT_PATH_MM, CONTACT_PATH_LIMIT_MM = 80.0, 160.0
HALF_DEPTH_MM = DEPTH_LIMIT_MM = 1.5
MAX_MEASURE = 1e6
"""Larger measures are rejected as invalid."""
_Measure = Annotated[float, number(0, MAX_MEASURE)]
Desirability = Annotated[float, number(0, 1)]


@dataclass(frozen=True)
class ScoreReference:
    """The reference of a trial's score, and the largest acceptable true TRE.

    The desirability of time is half of its range at `time_s`, and accuracy is one half at `tre_mm`.
    """

    time_s: _Measure
    tre_mm: _Measure
    limit_mm: _Measure = LIMIT_MM


@dataclass(frozen=True)
class ScoreMeasures:
    """The measures of a trial that its score is computed from.

    Attributes:
        tre_mm: RMS true TRE over the region.
        pressing_depth_mm: RMS over the fiducials of how deep the tool was pressed in.
        common_bias_mm: length of the bias that all touches share; None of a trial without
            fiducials.
    """

    completion_time_s: _Measure
    tre_mm: _Measure
    contact_time_s: _Measure
    contact_path_mm: _Measure
    pressing_depth_mm: _Measure
    common_bias_mm: _Measure | None = None

    @classmethod
    def of(
        cls,
        completion_time_s: float,
        tre_mm: float,
        common_bias_mm: float | None,
        motion: Mapping[str, float],
    ) -> ScoreMeasures:
        try:
            time_s, path_mm, depth_mm = (float(motion[name]) for name in SAFETY_METRICS)
        except KeyError as error:
            raise InputError(
                f"The trial's contacts were not measured ({error.args[0]} is missing), so it "
                "cannot be scored."
            ) from None
        return cls(completion_time_s, tre_mm, time_s, path_mm, depth_mm, common_bias_mm)


SAFETY_METRICS = ("unintended_contact_time_s", "unintended_contact_path_mm", "pressing_depth_mm")
"""Motion metrics of `rastrainer.motion` that are scored."""


@dataclass(frozen=True)
class TrialScore:
    """The score of one trial and its parts.

    Attributes:
        score: above 0 up to 100; about 51 for a gentle trial at both references.
        time_desirability: from `TIME_FLOOR` (never done) to 1 (at once).
        accuracy_desirability: from 0 (no registration) to 1 (no error, no common bias).
        safety_desirability: from 0 to 1 (no unintended contact, nothing pressed in).
        is_unbiased: whether the common bias is; None if it was not scored.
        unshifted_tre_mm: true TRE at the target, had the skin not shifted; None if it had not.
            It does not count.
    """

    score: Annotated[float, number(0, 100)]
    time_desirability: Desirability
    accuracy_desirability: Desirability
    safety_desirability: Desirability
    is_accurate: bool
    is_unbiased: bool | None
    is_safe: bool
    measures: ScoreMeasures
    reference: ScoreReference
    version: str = SCORE_VERSION
    unshifted_tre_mm: _Measure | None = None

    @property
    def acceptable(self) -> bool:
        return self.is_accurate and self.is_unbiased is not False and self.is_safe

    @property
    def parts(self) -> dict[str, float]:
        parts = {"time": self.time_desirability, "accuracy": self.accuracy_desirability}
        if self.measures.common_bias_mm is not None:
            trueness = _trueness(self.measures.common_bias_mm)
            parts |= {"accuracy": self.accuracy_desirability / trueness, "common bias": trueness}
        return {**parts, "safety": self.safety_desirability}


def check_measures(measures: object, what: str) -> None:
    """Check that all fields of a dataclass are measures; `what` starts the error."""
    for name, value in vars(measures).items():
        if value is not None and not 0 <= value <= MAX_MEASURE:
            raise InputError(f"{what}: {name} must be a number from 0 to {MAX_MEASURE:g}.")


def passes(score: float, acceptable: bool, pass_mark: float) -> bool:
    return acceptable and score >= pass_mark


def score_trial(
    measures: ScoreMeasures,
    reference: ScoreReference,
    method: RegistrationMethod = RegistrationMethod.FIDUCIALS,
) -> TrialScore:
    """Return the score of a trial.

    Each method has its own references, and only fiducials have a common bias: scores are compared
    within one method.
    """
    check_measures(measures, "The trial's measures")
    bias_mm = measures.common_bias_mm
    if measures.completion_time_s == 0:
        raise InputError("The trial's completion time must be above 0 s.")
    if bias_mm is None and method is RegistrationMethod.FIDUCIALS:
        raise InputError("The common bias of a trial by fiducials must be a number of mm.")
    time = of_time(measures.completion_time_s, reference.time_s)
    accuracy = _accuracy(measures.tre_mm, bias_mm, reference)
    safety = _safety(measures.contact_time_s, measures.contact_path_mm, measures.pressing_depth_mm)
    is_accurate = measures.tre_mm <= reference.limit_mm
    is_unbiased = None if bias_mm is None else bias_mm <= COMMON_BIAS_LIMIT_MM
    is_safe = (
        measures.contact_time_s <= CONTACT_LIMIT_S
        and measures.contact_path_mm <= CONTACT_PATH_LIMIT_MM
        and measures.pressing_depth_mm <= DEPTH_LIMIT_MM
    )
    product = time * accuracy * safety
    if not (is_accurate and is_unbiased is not False and is_safe):
        product *= _worst_acceptable(reference)
    return TrialScore(
        score=100 * math.sqrt(product),
        time_desirability=time,
        accuracy_desirability=accuracy,
        safety_desirability=safety,
        is_accurate=is_accurate,
        is_unbiased=is_unbiased,
        is_safe=is_safe,
        measures=measures,
        reference=reference,
    )


def falling(value: float, half: float, power: int = 2) -> float:
    return 1 / (1 + (value / half) ** power)


def of_time(time_s: float, reference_s: float) -> float:
    """Return the desirability of a time: half of its range at the reference."""
    return TIME_FLOOR + (1 - TIME_FLOOR) * falling(time_s, reference_s)


def _accuracy(tre_mm: float, bias_mm: float | None, reference: ScoreReference) -> float:
    return falling(tre_mm, reference.tre_mm) * _trueness(bias_mm or 0.0)


def _trueness(bias_mm: float) -> float:
    return falling(bias_mm, HALF_COMMON_BIAS_MM, COMMON_BIAS_POWER)


def _safety(contact_time_s: float, contact_path_mm: float, depth_mm: float) -> float:
    return (
        falling(contact_time_s, HALF_CONTACT_S)
        * falling(contact_path_mm, HALF_CONTACT_PATH_MM)
        * falling(depth_mm, HALF_DEPTH_MM)
    )


def _worst_acceptable(reference: ScoreReference) -> float:
    """Return the product of the desirabilities at all limits and infinite time.

    As a factor it brings every trial beyond a limit below every acceptable one.
    """
    accuracy = _accuracy(reference.limit_mm, COMMON_BIAS_LIMIT_MM, reference)
    safety = _safety(CONTACT_LIMIT_S, CONTACT_PATH_LIMIT_MM, DEPTH_LIMIT_MM)
    return TIME_FLOOR * accuracy * safety
