"""The entries of a trial's journal: one record for each kind, and the times that all carry.

A class's `kind` is the key of its row in `docs/trial-journal.md`. Fields without a default are
always written. Positions are in World; a hash of the trajectory is in entries that have to be on
the disk before they are published.
"""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime, timezone
from typing import Annotated, Any, ClassVar, NamedTuple

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import RAS_LIMIT_MM
from rastrainer.head.trial_head import UNMOVED, SkinShift
from rastrainer.json_checks import (
    check_of,
    number,
    numbers,
    one_of,
    point,
    text,
    transform,
    whole_number,
)
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.procedure.record import UsedRegistration
from rastrainer.protocol import Mode, Phase, Proximity, RegistrationMethod

FORMAT = "rastrainer-trial-journal"
FORMAT_VERSION = 1
GUIDED_TOUCHES = 3
_LARGEST = 2**53


Words = Annotated[str, check_of(lambda value: isinstance(value, str), "text")]
Object = Annotated[Mapping[str, Any], check_of(lambda value: isinstance(value, dict), "an object")]
Count = Annotated[int, whole_number(0, _LARGEST)]
Millimeters = Annotated[float, number(-1e6, 1e6, "mm")]
Seconds = Annotated[float, number(0, 1e9, "s")]
Position = Annotated[tuple[float, float, float], numbers(3, 1e6, "mm")]
Seed = Annotated[int, whole_number(0, 2**64 - 1)]
Versions = Mapping[str, Words]
_RasPoint = Annotated[np.ndarray, point(RAS_LIMIT_MM)]


def iso(moment: datetime) -> str:
    return moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")


@dataclass(frozen=True)
class Stamp:
    """When an entry was recorded; the monotonic clock is for durations, since `utc` may jump."""

    tick: Count
    sim_time_s: Seconds
    monotonic_s: Annotated[float, number(-1e12, 1e12, "s")]
    utc: Words

    @classmethod
    def now(cls, tick: int, sim_time: float) -> Stamp:
        return cls(tick, sim_time, time.monotonic(), iso(datetime.now(timezone.utc)))


KINDS: dict[str, type[Entry]] = {}
"""The classes of entries by the kind that a line names."""


class Entry:
    """The content of a line, without its times, before which `own_keys_first` keys are written."""

    kind: ClassVar[str]
    own_keys_first: ClassVar[int] = 0

    def __init_subclass__(cls, kind: str = "", own_keys_first: int = 0) -> None:
        if kind:
            cls.kind, cls.own_keys_first = kind, own_keys_first
            KINDS[kind] = cls


class Line(NamedTuple):
    """An entry and its times."""

    at: Stamp
    entry: Entry

    def to_json(self) -> dict[str, Any]:
        own = list(record_to_json(self.entry).items())
        first = self.entry.own_keys_first
        times = record_to_json(self.at)
        return {"kind": self.entry.kind, **dict(own[:first]), **times, **dict(own[first:])}


def read_line(values: Mapping[str, Any]) -> Line:
    """Return the line that a decoded JSON object holds."""
    kind = values.get("kind")
    if not isinstance(kind, str) or kind not in KINDS:
        raise InputError(f"A journal entry is malformed: it has the kind {json.dumps(kind)[:40]}.")
    what = f"A journal entry is malformed: {kind}"
    return Line(record_from_json(Stamp, values, what), record_from_json(KINDS[kind], values, what))


@dataclass(frozen=True)
class PlayingSession:
    """Simulated seconds in a second, None for as fast as possible; whether seeds were chosen."""

    speed: Annotated[float | None, number(0, 1e6)]
    is_seeded: bool


REAL_TIME = PlayingSession(1.0, False)


@dataclass(frozen=True)
class StartingPoint:
    """Where a simulation starts: after another one's state, or within a trial's journal.

    `tick`, `sim_time_s` and `revision` (of the training state) belong to the last step before;
    `camera` is the view, None for the view at the start.
    """

    tick: Count
    sim_time_s: Seconds
    revision: Count
    camera: Words | None


AT_ZERO = StartingPoint(0, 0.0, 0, None)


@dataclass(frozen=True)
class RecordedContent:
    """Name and hash of a scenario or a procedure."""

    name: Words
    sha256: Words


@dataclass(frozen=True)
class RecordedMethod:
    """The method of a trial without fiducials, and the hash of the scenario's landmarks."""

    name: RegistrationMethod
    landmarks_sha256: Words


@dataclass(frozen=True, kw_only=True)
class JournalHeader(Entry, kind="header", own_keys_first=4):
    """The first line: the length of a tick, the state before the first step, the settings.

    The seed of the head's pose is not written here but in the line that ends the trial, and until
    then in the file next to the journal.
    """

    format: Annotated[str, one_of(FORMAT)]
    version: Annotated[int, whole_number(FORMAT_VERSION, FORMAT_VERSION)]
    number: Count
    series: Words
    trial_id: Words
    trainee: Words
    task: Words
    shortest_path_mm: Millimeters | None
    mode: Annotated[str, one_of(*Mode)]
    tick_s: Annotated[float, number(1e-4, 0.1, "s")]
    session: PlayingSession
    before: StartingPoint
    scenario: RecordedContent
    robot: Words
    settings: Object
    procedure: RecordedContent | None = None
    method: RecordedMethod | None = None
    versions: Versions
    seed: Seed | None = None

    @property
    def registration_method(self) -> RegistrationMethod:
        return self.method.name if self.method else RegistrationMethod.FIDUCIALS


@dataclass(frozen=True)
class Input(Entry, kind="input"):
    """The sticks from here on."""

    translation: Annotated[tuple[float, float, float], numbers(3, 1.0)]
    rotation: Annotated[tuple[float, float], numbers(2, 1.0)]
    fine: bool
    operator: Words


@dataclass(frozen=True)
class CommandDone(Entry, kind="command"):
    """A command was carried out."""

    name: Words
    arguments: Object
    sender: Words


@dataclass(frozen=True, kw_only=True)
class Sample(Entry, kind="sample"):
    """The arm, 50 times per simulated second while the trial runs."""

    q: Annotated[tuple[float, ...], numbers(7, 1e3, "rad")]
    tip_mm: Position
    clearance_mm: Millimeters
    depth_mm: Millimeters
    feed_mm: Millimeters | None = None
    moved_by: Words


@dataclass(frozen=True, kw_only=True)
class AcceptedTouch(Entry, kind="touch"):
    """A touch was accepted."""

    label: Words
    position_mm: Position
    measured_mm: Position | None = None
    clearance_mm: Millimeters
    depth_mm: Millimeters
    kept: Count
    trajectory_sha256: Words = ""


@dataclass(frozen=True, kw_only=True)
class TracePoint(Entry, kind="trace"):
    """The tip left a point of a trace."""

    position_mm: Position
    measured_mm: Position | None = None
    kept: Count


@dataclass(frozen=True)
class Stroke(Entry, kind="stroke"):
    """A stroke of a trace began, ended or was undone."""

    on: bool
    kept: Count
    strokes: Count
    undone: bool = False
    trajectory_sha256: Words = ""


@dataclass(frozen=True)
class Undo(Entry, kind="undo"):
    """The last touch was undone."""

    label: Words
    kept: Count
    next_point: Words
    trajectory_sha256: Words = ""


@dataclass(frozen=True, kw_only=True)
class AcceptedCheckpoint(Entry, kind="checkpoint"):
    """A checkpoint was touched."""

    checkpoint: Words
    position_mm: Position
    clearance_mm: Millimeters
    depth_mm: Millimeters
    error_mm: Millimeters
    kept: Count
    trajectory_sha256: Words = ""


@dataclass(frozen=True, kw_only=True)
class Rejected(Entry, kind="rejected"):
    """A refused touch: of the fiducial `label`, or of a checkpoint, "" without one nearby."""

    label: Words | None = None
    checkpoint: Words | None = None
    position_mm: Position
    measured_mm: Position | None = None
    clearance_mm: Millimeters
    depth_mm: Millimeters
    message: Words


@dataclass(frozen=True)
class FeedChange(Entry, kind="feed"):
    """What drill or instrument meets has changed."""

    phase: Phase
    layer: Words
    feed_mm: Millimeters


@dataclass(frozen=True, kw_only=True)
class ProximityChange(Entry, kind="proximity"):
    """The tool came near the head, touched it or left it."""

    from_: Proximity
    to: Proximity
    clearance_mm: Millimeters
    depth_mm: Millimeters | None = None


@dataclass(frozen=True)
class MotionEnd(Entry, kind="motion"):
    """A commanded motion ended."""

    outcome: Words


@dataclass(frozen=True)
class Reach(Entry, kind="reach"):
    """A target went out of reach or a part of the arm got in the way, or no longer."""

    is_within_reach: bool
    obstacle: Words


@dataclass(frozen=True)
class CameraChange(Entry, kind="camera"):
    """Another view was chosen."""

    camera: Words


@dataclass(frozen=True)
class ProcedureAt:
    """Where a procedure is: its stage, also during a pause, and the trajectory, from 0."""

    name: Words
    stage: Phase
    trajectory: Count


@dataclass(frozen=True)
class Ahead:
    """The true distances along the guide's axis; None if it misses skin or skull."""

    skin_mm: Millimeters | None
    outer_mm: Millimeters | None
    inner_mm: Millimeters | None


@dataclass(frozen=True, kw_only=True)
class PhaseChange(Entry, kind="phase"):
    """The trial's phase and state from here on; a step of a procedure also has its own data."""

    trial_id: Words
    phase: Phase
    trainee: Words
    task: Words
    mode: Words
    next_point: Words | None
    procedure: ProcedureAt | None = None
    method: RegistrationMethod | None = None
    traced: Count | None = None
    instruction: Words
    feed_mm: Millimeters | None = None
    drilled_mm: Millimeters | None = None
    completion_time_s: Seconds | None = None
    registration: UsedRegistration | None = None
    position_mm: Position | None = None
    direction: Annotated[tuple[float, float, float], numbers(3, 1.1)] | None = None
    ahead: Ahead | None = None
    seed: Seed | None = None
    trajectory_sha256: Words = ""


@dataclass(frozen=True)
class RecordedTruth:
    """Where the head really was, mm; secret until a registration is submitted.

    The true error is reported at the target. The fiducials are the task's, by their labels; the
    skin has shifted compared with the images.
    """

    head_to_world: Annotated[np.ndarray, transform]
    target_ras: _RasPoint
    fiducials_ras: Mapping[str, _RasPoint]
    skin: SkinShift = UNMOVED


@dataclass(frozen=True, kw_only=True)
class Registered(PhaseChange, kind="registered"):
    """The end of a trial: its truth, and its record as JSON."""

    truth: RecordedTruth
    record: Object = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Aborted(PhaseChange, kind="aborted"):
    """The end of an aborted trial."""


@dataclass(frozen=True)
class Attempt(Entry, kind="attempt"):
    """The record of an aborted trial, as JSON; with the seed if it was never resumed."""

    record: Object
    seed: Seed | None = None


@dataclass(frozen=True, kw_only=True)
class Continued(Entry, kind="continued"):
    """The trial is resumed after its server ended."""

    since_s: Seconds
    session: PlayingSession
    camera: Words
    phase: Phase
    kept: Count
    next_point: Words | None
    versions: Versions


@dataclass(frozen=True)
class Stopped(Entry, kind="stopped"):
    """The server was shut down during the trial."""


@dataclass(frozen=True)
class Acknowledged(Entry, kind="acknowledged"):
    """A client confirmed that it has stored the record."""

    sender: Words


@dataclass(frozen=True)
class FinalRegistration(Entry, kind="registration"):
    """A final registration: the arguments of SubmitRegistration."""

    sender: Words
    arguments: Object


@dataclass(frozen=True)
class Scored(Entry, kind="scored"):
    """A score: the arguments of TrialScored."""

    sender: Words
    arguments: Object


@dataclass(frozen=True)
class CaseClock(Entry, kind="case"):
    """A case of a drill was shown, or its clock has run on; `time_s` includes the checks."""

    number: Count
    time_s: Seconds


@dataclass(frozen=True)
class CheckedPlace(Entry, kind="check"):
    """A place of a case was checked, for which time was taken from its clock."""

    place: Words
    time_s: Seconds


@dataclass(frozen=True)
class ReadImages(Entry, kind="images"):
    """The images of a case were read for the first time."""

    time_s: Seconds


@dataclass(frozen=True)
class CaseDecided(Entry, kind="decided"):
    """A case was decided: its `DecidedCase` as JSON, with the truth."""

    case: Object


@dataclass(frozen=True)
class DrillEnd(Entry, kind="drill"):
    """The end of a drill: its record as JSON, and the seed by which its cases were drawn."""

    record: Object
    seed: Seed


class Report(Entry):
    """How a trial is seen and prepared; the simulation does not depend on it."""


@dataclass(frozen=True)
class DisplayReport(Report, kind="display", own_keys_first=5):
    """A view's report on the frames of the last second.

    `device` is the model of the headset or the name of the browser, "" if unknown; an unknown
    refresh rate is 0.
    """

    view: str  # "desktop", "page" or "headset"
    device: Annotated[str, text(80, 0)]
    refresh_hz: Annotated[float, number(0, 1e6, "Hz")]
    shown: Annotated[int, whole_number(0, 1_000_000)]
    dropped: Annotated[int, whole_number(0, 1_000_000)]


@dataclass(frozen=True)
class ViewReport(Report, kind="view", own_keys_first=5):
    """A view, compared with the scenario's camera, and whether it has gone there automatically.

    `follows` is whether it goes to the best view of each next point, as set.
    """

    azimuth_deg: Annotated[float, number(-360, 360)]  # about the vertical, from above
    elevation_deg: Annotated[float, number(-360, 360)]
    zoom: Annotated[float, number(0, 1000)]
    is_automatic: bool
    follows: bool


@dataclass(frozen=True)
class GuidanceReport(Report, kind="guidance", own_keys_first=1):
    """How the trainee is guided to the next point in this trial: "words", "arrow" or "none"."""

    guidance: str


@dataclass(frozen=True)
class GhostReport(Report, kind="ghost", own_keys_first=1):
    """Which earlier trial is shown next to the arm in this trial: "own best" or "expert".

    It has no UUID: a trainee who is deleted leaves no trace in others' journals.
    """

    ghost: str


@dataclass(frozen=True)
class TutorialReport(Report, kind="tutorial", own_keys_first=5):
    """A finished tutorial: its duration without menus, and the errors of the first touch and of
    the guided touches at the end."""

    device: str
    mode: Annotated[str, one_of(*Mode)]
    duration_s: Annotated[float, number(0, 1e6, "s")]
    first_error_mm: Annotated[float, number(0, 1e4, "mm")]
    errors_mm: Annotated[tuple[float, ...], numbers(GUIDED_TOUCHES, 1e4, "mm")]
