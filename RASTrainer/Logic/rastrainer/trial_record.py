"""The record of a finished trial, as the simulator delivers it and the study keeps it.

Both sides import this one file: what a record must hold is said here and nowhere else.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from typing import Any

import numpy as np

from rastrainer import protocol
from rastrainer.errors import InputError
from rastrainer.protocol import FIDUCIAL_COUNT, WORLD_LIMIT_MM, Argument, Mode, TouchRule

TIME_LIMIT_S = 1e6
TOUCH_LIMIT = 1_000_000
VERSIONS_LIMIT = 32
MOTION_LIMIT = 100
DISPLAY_LIMIT = 16


@dataclass(frozen=True)
class TouchedPoint:
    """One fiducial as it was touched.

    Attributes:
        label: The fiducial's label, `1` to `15` in the shipped tasks.
        position_mm: Position of the tool tip in `World`, in mm.
        sim_time_s: Simulated time of the touch, in s.
        utc: Wall time of the touch, ISO 8601 in UTC.
    """

    label: str
    position_mm: tuple[float, float, float]
    sim_time_s: float
    utc: str

    def to_json(self) -> dict[str, Any]:
        """Return the JSON object that `touched_point` reads."""
        return {
            "label": self.label,
            "positionMm": list(self.position_mm),
            "simTime": self.sim_time_s,
            "utc": self.utc,
        }


@dataclass(frozen=True)
class TrialRecord:
    """A finished trial: who, what, when, and the fifteen touches that were kept, in their order.

    Attributes:
        trial_id: UUID in its canonical spelling.
        trainee: Pseudonym of the trainee.
        task: Name of the task, such as `task-1`.
        mode: `desktop` or `hmd`.
        scenario: Name of the scenario.
        started_utc: ISO 8601 in UTC; the wall clock may jump, so no duration is taken from it.
        completed_utc: ISO 8601 in UTC.
        completion_time_s: Simulated time from the start to the last kept touch, without pauses.
        points: The kept touches; their labels differ and their times do not fall.
        rejected_touches: Number of touches that were refused (too far off, wrong fiducial).
        undone_touches: Number of touches that the trainee took back.
        versions: Name and version of each program and format that made the record.
        seed: Seed of the trial, where the simulator tells it.
        touch_rule: Which touches counted, a `TouchRule`; in older records the paper's.
        motion: Motion metrics by name (`rastrainer.motion.definitions`); empty in older records.
        display: What the trainee looked at: `kind`, `device`, `refreshHz`, `shownFrames` and
            `droppedFrames`; empty where no view told it.
    """

    trial_id: str
    trainee: str
    task: str
    mode: str
    scenario: str
    started_utc: str
    completed_utc: str
    completion_time_s: float
    points: tuple[TouchedPoint, ...]
    rejected_touches: int
    undone_touches: int
    versions: Mapping[str, str]
    seed: int | None = None
    touch_rule: str = TouchRule.WITHIN_RADIUS.value
    motion: Mapping[str, float] = field(default_factory=dict)
    display: Mapping[str, str | float] = field(default_factory=dict)

    @property
    def labels(self) -> tuple[str, ...]:
        """Labels of the touched fiducials, in the order of touching."""
        return tuple(point.label for point in self.points)

    @property
    def positions_mm(self) -> np.ndarray:
        """Touched points in `World`, (n, 3) float, in mm."""
        return np.array([point.position_mm for point in self.points], dtype=float)

    @property
    def touch_times_s(self) -> np.ndarray:
        """Simulated time of each touch, (n,) float, in s."""
        return np.array([point.sim_time_s for point in self.points], dtype=float)

    @classmethod
    def from_json(cls, value: object) -> TrialRecord:
        """Return the record that a decoded JSON object holds.

        Keys that this version does not know are ignored, so that a newer simulator may add some.

        Raises:
            InputError: a key is missing or holds something else than it should.
        """
        fields = checked_keys(value, _RECORD_KEYS, "The trial record")
        record = cls(**{_PYTHON_NAMES[key]: fields[key] for key in fields})
        check_points(record.points)
        return record

    def to_json(self) -> dict[str, Any]:
        """Return the JSON object that `from_json` reads."""
        json_object = {key: getattr(self, name) for key, name in _PYTHON_NAMES.items()}
        json_object["versions"] = dict(self.versions)
        json_object["motion"] = dict(self.motion)
        json_object["display"] = dict(self.display)
        json_object["points"] = [point.to_json() for point in self.points]
        return json_object


def utc_time(value: Any) -> str:
    """Accept an ISO 8601 date and time in UTC, such as `2024-05-17T09:30:00.250Z`.

    Raises:
        ValueError: anything else; the words follow "must be".
    """
    try:
        # `fromisoformat` reads the letter Z only from Python 3.11 on.
        moment = datetime.fromisoformat(value.replace("Z", "+00:00"))
    except (AttributeError, TypeError, ValueError):
        moment = None
    if moment is None or moment.utcoffset() != timedelta(0):
        raise ValueError("an ISO 8601 date and time in UTC, such as 2024-05-17T09:30:00Z")
    return value


def touched_point(value: Any) -> TouchedPoint:
    """Return the point that a decoded JSON object holds; raise `InputError` where it is none."""
    fields = checked_keys(value, _POINT_KEYS, "Each point of the trial record")
    return TouchedPoint(fields["label"], fields["positionMm"], fields["simTime"], fields["utc"])


def _all_points(value: Any) -> tuple[TouchedPoint, ...]:
    if not isinstance(value, (list, tuple)) or len(value) != FIDUCIAL_COUNT:
        raise ValueError(f"a list of {FIDUCIAL_COUNT} points")
    return tuple(touched_point(item) for item in value)


def checked_versions(value: Any) -> dict[str, str]:
    """Accept names of programs with their versions; raise `ValueError` for anything else."""
    words = "an object of at most 32 names with their versions as text"
    if not isinstance(value, dict) or len(value) > VERSIONS_LIMIT:
        raise ValueError(words)
    check = protocol.text()
    try:
        return {check(name): check(version) for name, version in value.items()}
    except ValueError:
        raise ValueError(words) from None


def _motion(value: Any) -> dict[str, float]:
    words = f"an object of at most {MOTION_LIMIT} names with finite numbers"
    if not isinstance(value, Mapping) or len(value) > MOTION_LIMIT:
        raise ValueError(words)
    check_name, check_number = protocol.text(), protocol.number(-1e9, 1e9)
    try:
        return {check_name(name): check_number(number) for name, number in value.items()}
    except ValueError:
        raise ValueError(words) from None


def _display(value: Any) -> dict[str, str | float]:
    words = f"an object of at most {DISPLAY_LIMIT} names with texts or finite numbers"
    if not isinstance(value, Mapping) or len(value) > DISPLAY_LIMIT:
        raise ValueError(words)
    check_text, check_number = protocol.text(), protocol.number(0, 1e9)
    try:
        return {
            check_text(name): check_text(told) if isinstance(told, str) else check_number(told)
            for name, told in value.items()
        }
    except ValueError:
        raise ValueError(words) from None


def _optional(check: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return lambda value: None if value is None else check(value)


def checked_keys(value: object, keys: Mapping[str, Argument], what: str) -> dict[str, Any]:
    """Return the checked values of a JSON object's known keys, defaults filled in.

    Raises:
        InputError: it is no object, or a key is missing or holds something else than it should;
            `what` begins the sentence.
    """
    if not isinstance(value, Mapping):
        raise InputError(f"{what} must be a JSON object.")
    fields = {}
    for key, argument in keys.items():
        if key not in value and argument.default is ...:
            raise InputError(f"{what} needs the key {json.dumps(key)}.")
        try:
            fields[key] = argument.check(value[key]) if key in value else argument.default
        except InputError:
            raise
        except ValueError as error:
            raise InputError(f"{what}: {key} must be {error}.") from None
    return fields


def check_points(points: tuple[TouchedPoint, ...]) -> None:
    """Raise `InputError` where a label stands twice, or a point before an earlier one."""
    seen: set[str] = set()
    for point in points:
        if point.label in seen:
            raise InputError(f"The trial record holds the label {json.dumps(point.label)} twice.")
        seen.add(point.label)
    for earlier, later in itertools.pairwise(points):
        if later.sim_time_s < earlier.sim_time_s:
            raise InputError(
                f"The trial record's points must be in the order of touching: "
                f"{later.label} was touched before {earlier.label}."
            )


_POINT_KEYS = {
    "label": Argument(protocol.text()),
    "positionMm": Argument(protocol.numbers(3, WORLD_LIMIT_MM, "mm")),
    "simTime": Argument(protocol.number(0, TIME_LIMIT_S, "s")),
    "utc": Argument(utc_time),
}

_RECORD_KEYS = {
    "trialId": Argument(protocol.trial_id),
    "trainee": Argument(protocol.text()),
    "task": Argument(protocol.text()),
    "mode": Argument(protocol.one_of(*(mode.value for mode in Mode))),
    "scenario": Argument(protocol.text()),
    "startedUtc": Argument(utc_time),
    "completedUtc": Argument(utc_time),
    "completionTimeS": Argument(protocol.number(0, TIME_LIMIT_S, "s")),
    "points": Argument(_all_points),
    "rejectedTouches": Argument(protocol.whole_number(0, TOUCH_LIMIT)),
    "undoneTouches": Argument(protocol.whole_number(0, TOUCH_LIMIT)),
    "versions": Argument(checked_versions),
    "seed": Argument(_optional(protocol.whole_number(0, 2**63 - 1)), None),
    "touchRule": Argument(
        protocol.one_of(*(rule.value for rule in TouchRule)), TouchRule.WITHIN_RADIUS.value
    ),
    "motion": Argument(_motion, {}),
    "display": Argument(_display, {}),
}

_PYTHON_NAMES = {
    "trialId": "trial_id",
    "trainee": "trainee",
    "task": "task",
    "mode": "mode",
    "scenario": "scenario",
    "startedUtc": "started_utc",
    "completedUtc": "completed_utc",
    "completionTimeS": "completion_time_s",
    "points": "points",
    "rejectedTouches": "rejected_touches",
    "undoneTouches": "undone_touches",
    "versions": "versions",
    "seed": "seed",
    "touchRule": "touch_rule",
    "motion": "motion",
    "display": "display",
}
