"""The record of an aborted trial, as the simulator delivers it and the study keeps it.

What was touched and then given up counts as tried: so nobody passes by aborting what went wrong.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rastrainer import protocol
from rastrainer.protocol import (
    FIDUCIAL_COUNT,
    KEPT_AFTER_S,
    OPEN_PHASES,
    TRIAL_RUN,
    Argument,
    Mode,
    Phase,
    TouchRule,
)
from rastrainer.trial_record import (
    TIME_LIMIT_S,
    TOUCH_LIMIT,
    TouchedPoint,
    check_points,
    checked_keys,
    checked_versions,
    touched_point,
    utc_time,
)


@dataclass(frozen=True)
class AbortedTrial:
    """A trial that was begun and never registered.

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
        undone_touches: Number of touches that the trainee took back.
        versions: Name and version of each program and format that made the record.
        touch_rule: Which touches counted, a `TouchRule`.
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

    @property
    def is_trial_run(self) -> bool:
        """Whether it was a trial run, which nobody passes or fails."""
        return self.task == TRIAL_RUN

    @property
    def is_after_all_touches(self) -> bool:
        """Whether all fiducials were touched: only Register was lacking."""
        return self.phase == Phase.COMPLETE.value

    @property
    def is_kept(self) -> bool:
        """Whether there is anything to tell of it: a touch, a refused one too, or some time."""
        touches = len(self.points) + self.rejected_touches + self.undone_touches
        return touches > 0 or self.elapsed_s > KEPT_AFTER_S

    @property
    def counts_as_failed(self) -> bool:
        """Whether it is a trial not passed: one of a scored task, with a touch that counted."""
        return not self.is_trial_run and len(self.points) + self.undone_touches > 0

    @classmethod
    def from_json(cls, value: object) -> AbortedTrial:
        """Return the record that a decoded JSON object holds; unknown keys are ignored.

        Raises:
            InputError: a key is missing or holds something else than it should.
        """
        fields = checked_keys(value, _KEYS, "The record of an aborted trial")
        record = cls(**{_PYTHON_NAMES[key]: fields[key] for key in fields})
        check_points(record.points)
        return record

    def to_json(self) -> dict[str, Any]:
        """Return the JSON object that `from_json` reads."""
        json_object = {key: getattr(self, name) for key, name in _PYTHON_NAMES.items()}
        json_object["versions"] = dict(self.versions)
        json_object["points"] = [point.to_json() for point in self.points]
        return json_object


def _points_so_far(value: Any) -> tuple[TouchedPoint, ...]:
    if not isinstance(value, (list, tuple)) or len(value) > FIDUCIAL_COUNT:
        raise ValueError(f"a list of at most {FIDUCIAL_COUNT} points")
    return tuple(touched_point(item) for item in value)


_KEYS = {
    "trialId": Argument(protocol.trial_id),
    "trainee": Argument(protocol.text()),
    "task": Argument(protocol.text()),
    "mode": Argument(protocol.one_of(*(mode.value for mode in Mode))),
    "scenario": Argument(protocol.text()),
    "startedUtc": Argument(utc_time),
    "abortedUtc": Argument(utc_time),
    "elapsedS": Argument(protocol.number(0, TIME_LIMIT_S, "s")),
    "phase": Argument(protocol.one_of(*(phase.value for phase in OPEN_PHASES))),
    "reason": Argument(protocol.text()),
    "points": Argument(_points_so_far),
    "rejectedTouches": Argument(protocol.whole_number(0, TOUCH_LIMIT)),
    "undoneTouches": Argument(protocol.whole_number(0, TOUCH_LIMIT)),
    "versions": Argument(checked_versions),
    "touchRule": Argument(protocol.one_of(*(rule.value for rule in TouchRule))),
}

_PYTHON_NAMES = {
    "trialId": "trial_id",
    "trainee": "trainee",
    "task": "task",
    "mode": "mode",
    "scenario": "scenario",
    "startedUtc": "started_utc",
    "abortedUtc": "aborted_utc",
    "elapsedS": "elapsed_s",
    "phase": "phase",
    "reason": "reason",
    "points": "points",
    "rejectedTouches": "rejected_touches",
    "undoneTouches": "undone_touches",
    "versions": "versions",
    "touchRule": "touch_rule",
}
