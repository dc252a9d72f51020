"""The record of an aborted trial, as delivered by the simulator and stored in the study.

An aborted trial with touches counts as an attempt: aborting bad trials helps no one to pass.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rastrainer import json_checks
from rastrainer.files.json_fields import from_json_object, json_object
from rastrainer.json_checks import Argument
from rastrainer.protocol import (
    FIDUCIAL_COUNT,
    MIN_ABORTED_S,
    OPEN_PHASES,
    TRACED_METHODS,
    TRIAL_RUN,
    Phase,
    RegistrationMethod,
)
from rastrainer.trial.record import (
    MAX_TRACE_POINTS,
    SHARED_CHECKS,
    TIME_LIMIT_S,
    TouchedPoint,
    check_points,
    played_method,
    points_up_to_all,
    utc_time,
)


@dataclass(frozen=True)
class AbortedTrial:
    """A trial that was started and never registered.

    Attributes:
        trial_id: UUID in its canonical spelling.
        trainee: Pseudonym of the trainee.
        task: Name of the task; also that of the trial run.
        mode: `desktop` or `hmd`.
        scenario: Name of the scenario.
        started_utc: ISO 8601 in UTC.
        aborted_utc: ISO 8601 in UTC.
        elapsed_s: Simulated time from the start to the end, or to the last touch where all were
            made; without pauses.
        phase: In which it was aborted: `running`, `paused`, or `complete` after all touches.
        reason: An `AbortReason`, or that of a later version.
        points: The touches that were kept so far; their labels differ and their times do not fall.
        rejected_touches: Number of touches that were refused.
        undone_touches: Number of touches that the trainee undid.
        versions: Name and version of each program and format that made the record.
        touch_rule: Which touches counted, a `TouchRule`.
        method: By what it would have been registered; a `PLAYED_METHODS`.
        traced: Number of points that were traced over the skin.
        number: Of the trial among those of its simulator's folder; 0 if unknown.
        series: UUID of that numbering.
    """

    trial_id: str
    trainee: str
    task: str
    mode: str
    scenario: str
    started_utc: str
    aborted_utc: str
    elapsed_s: float
    phase: str
    reason: str
    points: tuple[TouchedPoint, ...]
    rejected_touches: int
    undone_touches: int
    versions: Mapping[str, str]
    touch_rule: str
    method: RegistrationMethod = RegistrationMethod.FIDUCIALS
    traced: int = 0
    number: int = 0
    series: str = ""

    @property
    def done(self) -> str:
        """How far the trainee came, such as "3 of 15 points touched"."""
        touched = len(self.points)
        if self.method is RegistrationMethod.FIDUCIALS:
            return f"{touched} of {FIDUCIAL_COUNT} points touched"
        landmarks = f"{touched} landmark{'' if touched == 1 else 's'} touched"
        if self.method not in TRACED_METHODS:
            return landmarks
        return f"{landmarks} and {self.traced} points traced"

    @property
    def is_trial_run(self) -> bool:
        """Whether it was a trial run, which is neither passed nor failed."""
        return self.task == TRIAL_RUN

    @property
    def is_after_all_touches(self) -> bool:
        """Whether all fiducials were touched and only Register was missing."""
        return self.phase == Phase.COMPLETE.value

    @property
    def is_kept(self) -> bool:
        """Whether a study stores it: it has a touch, even a refused one, or took some time."""
        touches = len(self.points) + self.rejected_touches + self.undone_touches
        return touches > 0 or self.elapsed_s > MIN_ABORTED_S

    @property
    def counts_as_failed(self) -> bool:
        """Whether it counts as not passed: a scored task with a kept or undone touch."""
        return not self.is_trial_run and len(self.points) + self.undone_touches > 0

    @classmethod
    def from_json(cls, value: object) -> AbortedTrial:
        """Return the record in a decoded JSON object; unknown keys are ignored."""
        record = from_json_object(cls, value, _CHECKS, "The record of an aborted trial")
        check_points(record.points)
        return record

    def to_json(self) -> dict[str, Any]:
        """Return the JSON object that `from_json` reads."""
        # Records of touched fiducials stay as they were before there was anything else.
        is_left_out = {
            "method": self.method is RegistrationMethod.FIDUCIALS,
            "traced": not self.traced,
            "number": not self.number,
            "series": not self.series,
        }
        return {key: item for key, item in json_object(self).items() if not is_left_out.get(key)}


_CHECKS = {
    **SHARED_CHECKS,
    "abortedUtc": Argument(utc_time),
    "elapsedS": Argument(json_checks.number(0, TIME_LIMIT_S, "s")),
    "phase": Argument(json_checks.one_of(*(phase.value for phase in OPEN_PHASES))),
    "reason": Argument(json_checks.text()),
    "points": Argument(points_up_to_all),
    "method": Argument(played_method, RegistrationMethod.FIDUCIALS),
    "traced": Argument(json_checks.whole_number(0, MAX_TRACE_POINTS), 0),
}
