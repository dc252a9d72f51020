"""Calibration of the expected target error: true against expected errors of trials.

Only a simulator knows the true error. It is compared with the expected TRE and interval stored
before the truth was revealed.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from rastrainer.number_text import fixed, percent
from rastrainer.protocol import TRIAL_RUN
from rastrainer.registration.distributions import Proportion, proportion
from rastrainer.trial.trial_row import TrialRow

MIN_SHARE_TRIALS = 5
"""Fewer trials have no meaningful share."""


@dataclass(frozen=True)
class CalibrationPoint:
    """One trial: its true error at the scenario's target, the expected RMS and 95 % interval."""

    trainee: str
    mode: str
    task: str
    expected_mm: float
    interval_mm: tuple[float, float]
    true_mm: float

    @property
    def is_inside(self) -> bool:
        return self.interval_mm[0] <= self.true_mm <= self.interval_mm[1]


@dataclass(frozen=True)
class TreCalibration:
    """The trials of a study with both errors, by expected TRE, and how many lack one of them."""

    points: tuple[CalibrationPoint, ...]
    without_truth: int = 0
    without_expectation: int = 0

    @property
    def inside(self) -> Proportion | None:
        if not self.points:
            return None
        return proportion(sum(point.is_inside for point in self.points), len(self.points))

    @property
    def above(self) -> int:
        """Number of true errors above their interval, the harmful side."""
        return sum(point.true_mm > point.interval_mm[1] for point in self.points)

    @property
    def expected_rms_mm(self) -> float:
        return float(np.sqrt(np.mean([point.expected_mm**2 for point in self.points])))

    @property
    def true_rms_mm(self) -> float:
        return float(np.sqrt(np.mean([point.true_mm**2 for point in self.points])))

    def of_mode(self, mode: str) -> TreCalibration:
        return TreCalibration(tuple(point for point in self.points if point.mode == mode))

    def sentences(self) -> list[str]:
        count, inside = len(self.points), self.inside
        found = []
        if inside is None:
            found.append("No trial has both an expected and a true target error.")
        else:
            found.append(
                f"{inside.count} of {count} true errors ({share_text(inside)}) lie within the 95 % "
                f"interval that was given before (larger: {self.above}, smaller: "
                f"{count - inside.count - self.above}). Root mean square: true "
                f"{fixed(self.true_rms_mm, 2)} mm, expected {fixed(self.expected_rms_mm, 2)} mm."
            )
        if 0 < count < MIN_SHARE_TRIALS:
            found.append(f"{count} trial{'s' if count > 1 else ''} can say nothing about a share.")
        for missing, what in ((self.without_truth, "true"), (self.without_expectation, "expected")):
            if missing:
                trials = "1 trial has" if missing == 1 else f"{missing} trials have"
                found.append(f"{trials} no {what} target error and cannot be shown.")
        return found


def calibration_of(trials: Iterable[TrialRow]) -> TreCalibration:
    """Return the calibration of the rigid registrations of trials; trial runs are left out."""
    points, without_truth, without_expectation = [], 0, 0
    for trial in trials:
        values = trial.values
        if trial.task == TRIAL_RUN:
            continue
        if not {"expected_tre_mm", "tre_low_mm"} <= values.keys():
            without_expectation += 1
        elif "true_tre_mm" not in values:
            without_truth += 1
        else:
            interval = values["tre_low_mm"], values["tre_high_mm"]
            errors = values["expected_tre_mm"], interval, values["true_tre_mm"]
            points.append(CalibrationPoint(trial.trainee, trial.mode, trial.task, *errors))
    ordered = tuple(sorted(points, key=lambda point: (point.expected_mm, point.true_mm)))
    return TreCalibration(ordered, without_truth, without_expectation)


def share_text(inside: Proportion) -> str:
    low, high = inside.interval
    return f"{percent(inside.share)} [{100 * low:.0f}, {100 * high:.0f}]"
