"""True against expected target error of trials: how honest the expectation was.

Only a simulator can draw it, since only there the truth is known. What is compared is what was
reported before the truth was known: the expected TRE and its interval, as stored with each trial.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from rastrainer.number_text import fixed, percent
from rastrainer.protocol import TRIAL_RUN
from rastrainer.registration.fits import RIGID
from rastrainer.statistics.intervals import Proportion, proportion
from rastrainer.study.database.values import StoredTrial

MIN_SHARE_TRIALS = 5
"""Of fewer trials a share says nothing."""


@dataclass(frozen=True)
class CalibrationPoint:
    """One trial, errors at the scenario's target in mm.

    Attributes:
        trainee, mode, task: Of the trial.
        expected_mm: Expected TRE, RMS.
        interval_mm: In which the true TRE was to lie.
        true_mm: The true TRE.
        allows_for_offset: Whether expectation and interval allow for an offset that all touches
            share; older ones do not.
    """

    trainee: str
    mode: str
    task: str
    expected_mm: float
    interval_mm: tuple[float, float]
    true_mm: float
    allows_for_offset: bool = True

    @property
    def is_inside(self) -> bool:
        """Whether the true error lies in the interval."""
        return self.interval_mm[0] <= self.true_mm <= self.interval_mm[1]

    @property
    def is_above(self) -> bool:
        """Whether the true error is larger than the interval allows: the harmful side."""
        return self.true_mm > self.interval_mm[1]


@dataclass(frozen=True)
class TreCalibration:
    """All trials of a study.

    Attributes:
        points: Trials of which both errors are known, by their expected TRE.
        without_truth: How many trials lack the true error alone.
        without_expectation: How many trials lack the expected one, as those without a score.
    """

    points: tuple[CalibrationPoint, ...]
    without_truth: int = 0
    without_expectation: int = 0

    @classmethod
    def of(
        cls,
        points: Iterable[CalibrationPoint],
        without_truth: int = 0,
        without_expectation: int = 0,
    ) -> TreCalibration:
        """Return a calibration with its points in order."""
        ordered = tuple(sorted(points, key=lambda point: (point.expected_mm, point.true_mm)))
        return cls(ordered, without_truth, without_expectation)

    @property
    def inside(self) -> Proportion | None:
        """The share inside the interval; None without trials.

        Raises:
            InputError: scipy is missing.
        """
        if not self.points:
            return None
        return proportion(sum(point.is_inside for point in self.points), len(self.points))

    @property
    def above(self) -> int:
        """How many true errors are larger than their interval allows."""
        return sum(point.is_above for point in self.points)

    @property
    def expected_rms_mm(self) -> float:
        """Root mean square of the expected errors."""
        return float(np.sqrt(np.mean([point.expected_mm**2 for point in self.points])))

    @property
    def true_rms_mm(self) -> float:
        """Root mean square of the true errors, which the expected one is to equal."""
        return float(np.sqrt(np.mean([point.true_mm**2 for point in self.points])))

    def of_mode(self, mode: str) -> TreCalibration:
        """Return the points of one mode alone."""
        return TreCalibration(tuple(point for point in self.points if point.mode == mode))

    def sentences(self) -> list[str]:
        """Return what there is to say.

        Raises:
            InputError: scipy is missing.
        """
        count, inside = len(self.points), self.inside
        found = []
        if inside is None:
            found.append("No trial has both an expected and a true target error.")
        else:
            found.append(
                f"{inside.count} of {count} true errors ({share_text(inside)}) lie in the 95 % "
                f"interval that was given before (larger: {self.above}, smaller: "
                f"{count - inside.count - self.above}). Root mean square: true "
                f"{fixed(self.true_rms_mm, 2)} mm, expected {fixed(self.expected_rms_mm, 2)} mm."
            )
        if 0 < count < MIN_SHARE_TRIALS:
            found.append(f"{count} trial{'s' if count > 1 else ''} can say nothing about a share.")
        old = sum(not point.allows_for_offset for point in self.points)
        if old:
            found.append(
                f"{old} of the intervals were computed before they allowed for an offset that all "
                "touches share, and are narrower."
            )
        for missing, what in ((self.without_truth, "true"), (self.without_expectation, "expected")):
            if missing:
                trials = "1 trial has" if missing == 1 else f"{missing} trials have"
                found.append(f"{trials} no {what} target error and cannot be shown.")
        return found


def calibration_of(trials: Iterable[StoredTrial]) -> TreCalibration:
    """Return the calibration of stored trials; trial runs, which are not registered, are no part.

    Errors are those of the rigid registration that was scored.
    """
    points, without_truth, without_expectation = [], 0, 0
    for trial in trials:
        record, rigid = trial.record, trial.registrations.get(RIGID)
        if record.task == TRIAL_RUN:
            continue
        if rigid is None or rigid.expected_tre_mm is None or rigid.tre_interval_mm is None:
            without_expectation += 1
        elif trial.true_tre_mm is None:
            without_truth += 1
        else:
            points.append(
                CalibrationPoint(
                    record.trainee,
                    record.mode,
                    record.task,
                    rigid.expected_tre_mm,
                    rigid.tre_interval_mm,
                    trial.true_tre_mm,
                    rigid.common_bias_sd_mm > 0.0,
                )
            )
    return TreCalibration.of(points, without_truth, without_expectation)


def share_text(inside: Proportion) -> str:
    """Return a share with its own interval, in percent."""
    low, high = inside.interval
    return f"{percent(inside.share)} [{100 * low:.0f}, {100 * high:.0f}]"
