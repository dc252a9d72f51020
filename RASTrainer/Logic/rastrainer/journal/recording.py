"""The trajectory and the replay of a trial, from its journal's entries."""

from __future__ import annotations

import contextlib
from array import array
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, NamedTuple, TypeVar

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.journal import entries
from rastrainer.journal.entries import Entry, JournalHeader, Line, PhaseChange, Sample, Stamp
from rastrainer.journal.folder import journals_of
from rastrainer.journal.journal_file import read_journal
from rastrainer.motion.trajectory import Interval, Touch, Trajectory
from rastrainer.protocol import PROCEDURE_PHASES, Phase, Proximity

_COLUMNS = 6
_T = TypeVar("_T", bound="Recording")


class Recording:
    """Collects a journal's entries; `trajectory` is the result so far.

    The simulator adds entries while the trial runs, a reader adds them from the file: the numbers
    are the same. Only the touching counts, not the procedure after it: there the time stands still,
    as in a pause, and the tool's movements are left out.
    """

    STANDING_STILL: ClassVar = frozenset((Phase.PAUSED, *PROCEDURE_PHASES))
    """Phases in which the trajectory's time stands still."""

    def __init__(self) -> None:
        self.start_s = self._tick_s = 0.0
        self._paused_s = 0.0
        self._paused_since: float | None = None
        # One row per sample: time in s, tip, clearance and depth in mm.
        # Half an hour takes 4 MB.
        self._samples = array("d")
        self._touches: list[Touch] = []
        self._refused: list[Touch] = []
        self._traced: list[Touch] = []
        self._undone = self._cameras = self._pauses = 0
        self._near: list[Interval] = []
        self._contacts: list[Interval] = []
        self._state, self._near_since, self._contact_since = Proximity.FREE, 0.0, 0.0
        self._contact_depth = 0.0
        self._fiducials: dict[str, np.ndarray] = {}
        self._shortest_path: float | None = None

    @classmethod
    def of(cls: type[_T], lines: Iterable[Line]) -> _T:
        recording = cls()
        for line in lines:
            recording.add(line)
        return recording

    def add(self, line: Line) -> None:
        entry, sim_time = line.entry, line.at.sim_time_s
        match entry:
            case Sample() if self._paused_since is None:
                time = self._trial_time(sim_time)
                if not self._samples or time > self._samples[-_COLUMNS]:
                    place = (*entry.tip_mm, entry.clearance_mm, entry.depth_mm)
                    self._samples += array("d", (time, *place))
                    self._press(entry.depth_mm)
            case JournalHeader():
                self._tick_s = entry.tick_s
                self.start_s = sim_time - self._tick_s
                self._shortest_path = entry.shortest_path_mm
            case PhaseChange() if entry.kind == PhaseChange.kind:
                self._phase(entry, sim_time - self._tick_s)
            case entries.Continued():
                # The time of an interruption is excluded.
                if entry.phase is Phase.PAUSED and self._paused_since is None:
                    self._paused_since = entry.since_s
            case entries.ProximityChange():
                self._proximity(entry, sim_time)
            case entries.Registered():
                pose = entry.truth.head_to_world
                self._fiducials = {
                    label: transforms.apply(pose, position)
                    for label, position in entry.truth.fiducials_ras.items()
                }
            case entries.CameraChange():
                self._cameras += 1
            case _:
                self._add_point(entry, sim_time)

    def _add_point(self, entry: Entry, sim_time: float) -> None:
        # Commands are carried out a tick before their line.
        before = sim_time - self._tick_s
        match entry:
            case entries.AcceptedTouch():
                self._press(entry.depth_mm)
                self._touches.append(self._touch(entry.label, entry.position_mm, before))
            case entries.Rejected() if entry.label is not None:
                self._refused.append(self._touch(entry.label, entry.position_mm, before))
            case entries.Undo():
                self._undone += 1
                del self._touches[entry.kept :]
            case entries.TracePoint():
                # A point is left at the end of its tick, unlike a touch.
                self._traced.append(self._touch("", entry.position_mm, sim_time))
            case entries.Stroke():
                del self._traced[entry.kept :]

    def trajectory(self) -> Trajectory:
        """Return the movement so far; open intervals end with the last sample."""
        samples = np.array(self._samples).reshape(-1, _COLUMNS)
        times, tip, clearance, depth = (
            samples[:, columns].copy() for columns in (0, slice(1, 4), 4, 5)
        )
        end = float(times[-1]) if len(times) else 0.0
        near, contacts = list(self._near), list(self._contacts)
        if self._state is not Proximity.FREE:
            near.append(Interval(self._near_since, max(end, self._near_since)))
        if self._state is Proximity.CONTACT:
            contacts.append(self._contact_until(max(end, self._contact_since)))
        return Trajectory(
            times_s=times,
            tip_mm=tip,
            clearance_mm=clearance,
            touches=tuple(self._touches),
            refused=tuple(self._refused),
            traced=tuple(self._traced),
            undone=self._undone,
            near=tuple(_with_clearance(interval, times, clearance) for interval in near),
            contacts=tuple(_with_clearance(interval, times, clearance) for interval in contacts),
            camera_switches=self._cameras,
            pauses=self._pauses,
            paused_s=self._paused_s,
            fiducials_mm=self._fiducials,
            shortest_path_mm=self._shortest_path,
            depth_mm=depth,
        )

    def _trial_time(self, sim_time: float) -> float:
        if self._paused_since is not None:
            sim_time = self._paused_since
        return sim_time - self.start_s - self._paused_s

    def _touch(self, label: str, place: tuple[float, float, float], sim_time: float) -> Touch:
        return Touch(label, place, self._trial_time(sim_time))

    def _phase(self, entry: PhaseChange, now: float) -> None:
        if entry.phase in self.STANDING_STILL:
            if self._paused_since is None:
                self._paused_since = now
                self._pauses += entry.phase is Phase.PAUSED
        elif self._paused_since is not None:
            self._paused_s += now - self._paused_since
            self._paused_since = None
        # Points that could not be written are undone: points of a trace beyond these, and touches
        # back to this fiducial.
        del self._traced[entry.traced or 0 :]
        labels = [touch.label for touch in self._touches]
        if entry.next_point in labels:
            del self._touches[labels.index(entry.next_point) :]

    def _proximity(self, entry: entries.ProximityChange, sim_time: float) -> None:
        # This event is at the end of its tick, unlike the events of commands.
        now = self._trial_time(sim_time)
        # An interval that begins and ends while the time stands still is left out.
        counts = self._paused_since is None
        if self._state is Proximity.FREE:
            self._near_since = now
        if entry.to is Proximity.FREE and (counts or self._near_since < now):
            self._near.append(Interval(self._near_since, now))
        if self._state is Proximity.CONTACT and (counts or self._contact_since < now):
            self._press(entry.depth_mm or 0.0)
            self._contacts.append(self._contact_until(now))
        if entry.to is Proximity.CONTACT:
            self._contact_since, self._contact_depth = now, 0.0
        self._state = entry.to

    def _press(self, depth_mm: float) -> None:
        if self._state is Proximity.CONTACT and self._paused_since is None:
            self._contact_depth = max(self._contact_depth, depth_mm)

    def _contact_until(self, end_s: float) -> Interval:
        return Interval(self._contact_since, end_s, greatest_depth_mm=self._contact_depth)


class WholeRecording(Recording):
    """Also keeps what the tool does in the phases of a procedure; only a pause takes no time."""

    STANDING_STILL: ClassVar = frozenset({Phase.PAUSED})


def read_trajectory(
    folder: Path, trial_id: str, pause: Callable[[], None] = lambda: None
) -> Trajectory | None:
    """Return the trajectory of a trial, or None without a usable journal; `pause` as in
    `read_journal`.
    """
    for path in journals_of(folder, trial_id):
        with contextlib.suppress(InputError):
            return Recording.of(read_journal(path, pause).lines(pause)).trajectory()
    return None


def _with_clearance(interval: Interval, times: np.ndarray, clearance: np.ndarray) -> Interval:
    first = np.searchsorted(times, interval.start_s)
    part = clearance[first : np.searchsorted(times, interval.end_s, side="right")]
    least = float(part.min()) if len(part) else np.inf
    return replace(interval, least_clearance_mm=least)


EVENTS = (
    *(PhaseChange, entries.AcceptedTouch, entries.Undo, entries.TracePoint, entries.Stroke),
    *(entries.Rejected, entries.AcceptedCheckpoint, entries.ProximityChange),
    *(entries.CameraChange, entries.CommandDone, entries.Continued),
)
"""Entries that change the view besides the arm."""


class RecordedEvent(NamedTuple):
    """An entry of `EVENTS`, its trial time, s, and when it was recorded."""

    time_s: float
    at: Stamp
    entry: Entry


@dataclass(frozen=True, eq=False)
class ReplayTrack:
    """A recorded trial in trial time, which excludes pauses; it starts at a simulated time.

    One row per sample: `q` are the joint angles (n, 7), rad, `feed_mm` (n,) how far drill or
    instrument was beyond the guide's tip, 0 without.
    """

    header: JournalHeader
    start_s: float
    trajectory: Trajectory
    q: np.ndarray
    feed_mm: np.ndarray
    events: tuple[RecordedEvent, ...]

    def at(self, time_s: float, rows: np.ndarray) -> np.ndarray:
        """Return what rows (n, ...) float, one per sample, are at a trial time, linearly."""
        times = self.trajectory.times_s
        after = min(max(1, int(np.searchsorted(times, time_s, side="right"))), len(times) - 1)
        begin, end = times[after - 1 : after + 1]
        share = float(np.clip((time_s - begin) / (end - begin), 0.0, 1.0))
        return (1.0 - share) * rows[after - 1] + share * rows[after]


def find_track(records: Path, trial_id: str) -> ReplayTrack:
    """Return the track of a trial from a folder of journals."""
    paths = journals_of(records, trial_id)
    if not paths:
        raise InputError(
            f"The journal of this trial is not in {records}: it can be replayed only on the "
            "computer whose simulator recorded it."
        )
    return read_track(paths[0])


def read_track(path: Path, pause: Callable[[], None] = lambda: None) -> ReplayTrack:
    """Return the track of a journal, as far as it is intact; `pause` as in `read_journal`."""
    reading = read_journal(path, pause)
    found = _ReplayRecording.of(reading.lines(pause))
    if len(found.postures) < 2:
        raise InputError(f"{path} has no movement to replay.")
    rows = np.array(found.postures), np.array(found.feeds)
    start_s, events = found.start_s, tuple(found.events)
    return ReplayTrack(reading.header, start_s, found.trajectory(), *rows, events)


class _ReplayRecording(WholeRecording):
    """Also keeps the joint angles of each kept sample, and the events."""

    def __init__(self) -> None:
        super().__init__()
        self.postures: list[tuple[float, ...]] = []
        self.feeds: list[float] = []
        self.events: list[RecordedEvent] = []

    def add(self, line: Line) -> None:
        known = len(self._samples)
        super().add(line)
        entry, sim_time = line.entry, line.at.sim_time_s
        if isinstance(entry, Sample) and len(self._samples) > known:
            self.postures.append(entry.q)
            self.feeds.append(entry.feed_mm or 0.0)
        if isinstance(entry, EVENTS):
            seen_s = sim_time if self._paused_since is None else self._paused_since
            # Keep events in order, also in the tick in which a trial is paused.
            before_s = self.events[-1].time_s if self.events else 0.0
            time_s = max(before_s, self._trial_time(seen_s))
            self.events.append(RecordedEvent(time_s, line.at, entry))
