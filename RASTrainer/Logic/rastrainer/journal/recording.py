"""The trajectory and the replay of a trial, from its journal's entries."""

from __future__ import annotations

import contextlib
import math
from array import array
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, TypeVar

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
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

    STANDING_STILL: ClassVar = frozenset(phase.value for phase in (Phase.PAUSED, *PROCEDURE_PHASES))
    """Phases in which the trajectory's time stands still."""

    def __init__(self) -> None:
        self._start_s = self._tick_s = 0.0
        self._paused_s = 0.0
        self._paused_since: float | None = None
        # One row per sample: time in s, tip, clearance and depth in mm (NaN if not recorded).
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
    def of(cls: type[_T], entries: Iterable[Mapping[str, Any]]) -> _T:
        """Return the recording of entries."""
        recording = cls()
        try:
            for entry in entries:
                recording.add(entry)
        except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
            raise InputError(f"A journal entry is malformed ({error!r}).") from None
        return recording

    def add(self, entry: Mapping[str, Any]) -> None:
        """Add one entry."""
        kind = entry["kind"]
        if kind == "sample":
            self._add_sample(entry)
        elif kind == "header":
            self._tick_s = entry["tickS"]
            self._start_s = entry["simTimeS"] - self._tick_s
            # Absent where the scenario does not give it.
            self._shortest_path = entry.get("shortestPathMm")
        elif kind == "phase":
            self._phase(entry)
        elif kind == "continued":
            # The time of an interruption is excluded.
            if entry["phase"] == Phase.PAUSED.value and self._paused_since is None:
                self._paused_since = entry["sinceS"]
        elif kind == "proximity":
            self._proximity(entry)
        elif kind == "registered":
            truth = entry["truth"]
            head_to_world = np.array(truth["headToWorld"], dtype=float).reshape(4, 4)
            self._fiducials = {
                label: transforms.apply(head_to_world, np.array(position, dtype=float))
                for label, position in truth["fiducialsRas"].items()
            }
        elif kind == "camera":
            self._cameras += 1
        else:
            self._add_point(entry)

    def _add_point(self, entry: Mapping[str, Any]) -> None:
        kind = entry["kind"]
        if kind == "touch":
            self._press(entry)
            self._touches.append(self._touch(entry["label"], entry, self._tick_s))
        elif kind == "rejected" and "checkpoint" not in entry:
            self._refused.append(self._touch(entry["label"], entry, self._tick_s))
        elif kind == "undo":
            self._undone += 1
            del self._touches[entry["kept"] :]
        elif kind == "trace":
            # A point is left at the end of its tick, unlike a touch.
            self._traced.append(self._touch("", entry))
        elif kind == "stroke":
            del self._traced[entry["kept"] :]

    def trajectory(self) -> Trajectory:
        """Return the movement so far; open intervals end with the last sample."""
        samples = np.array(self._samples).reshape(-1, _COLUMNS)
        times, tip, clearance = samples[:, 0].copy(), samples[:, 1:4].copy(), samples[:, 4].copy()
        depth = samples[:, 5].copy()
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
            depth_mm=None if np.isnan(depth).any() else depth,
        )

    def _add_sample(self, entry: Mapping[str, Any]) -> None:
        """Keep a sample that is later than the last one."""
        time = self._trial_time(entry["simTimeS"])
        is_late = self._samples and time <= self._samples[-_COLUMNS]
        if self._paused_since is not None or is_late:
            return
        x, y, z = entry["tipMm"]
        depth = entry.get("depthMm", math.nan)
        self._samples += array("d", (time, x, y, z, entry["clearanceMm"], depth))
        self._press(entry)

    def _trial_time(self, sim_time: float) -> float:
        if self._paused_since is not None:
            sim_time = self._paused_since
        return sim_time - self._start_s - self._paused_s

    def _touch(self, label: str, entry: Mapping[str, Any], before_s: float = 0.0) -> Touch:
        x, y, z = (float(value) for value in entry["positionMm"])
        return Touch(label, (x, y, z), self._trial_time(entry["simTimeS"] - before_s))

    def _phase(self, entry: Mapping[str, Any]) -> None:
        now = entry["simTimeS"] - self._tick_s
        if entry["phase"] in self.STANDING_STILL:
            if self._paused_since is None:
                self._paused_since = now
                self._pauses += entry["phase"] == Phase.PAUSED.value
        elif self._paused_since is not None:
            self._paused_s += now - self._paused_since
            self._paused_since = None
        # Points that could not be written are undone: points of a trace beyond these, and touches
        # back to this fiducial.
        del self._traced[entry.get("traced", 0) :]
        labels = [touch.label for touch in self._touches]
        if entry.get("nextPoint") in labels:
            del self._touches[labels.index(entry["nextPoint"]) :]

    def _proximity(self, entry: Mapping[str, Any]) -> None:
        # This event is at the end of its tick, unlike a command's.
        now, state = self._trial_time(entry["simTimeS"]), Proximity(entry["to"])
        # An interval that begins and ends while the time stands still is left out.
        counts = self._paused_since is None
        if self._state is Proximity.FREE:
            self._near_since = now
        if state is Proximity.FREE and (counts or self._near_since < now):
            self._near.append(Interval(self._near_since, now))
        if self._state is Proximity.CONTACT and (counts or self._contact_since < now):
            self._press(entry)
            self._contacts.append(self._contact_until(now))
        if state is Proximity.CONTACT:
            self._contact_since, self._contact_depth = now, 0.0
        self._state = state

    def _press(self, entry: Mapping[str, Any]) -> None:
        if self._state is Proximity.CONTACT and self._paused_since is None:
            self._contact_depth = max(self._contact_depth, entry["depthMm"])

    def _contact_until(self, end_s: float) -> Interval:
        return Interval(self._contact_since, end_s, greatest_depth_mm=self._contact_depth)


class WholeRecording(Recording):
    """Also keeps what the tool does in the phases of a procedure; only a pause takes no time."""

    STANDING_STILL: ClassVar = frozenset({Phase.PAUSED.value})


def read_trajectory(
    folder: Path, trial_id: str, pause: Callable[[], None] = lambda: None
) -> Trajectory | None:
    """Return the trajectory of a trial, or None without a usable journal; `pause` as in
    `read_journal`.
    """
    for path in journals_of(folder, trial_id):
        with contextlib.suppress(InputError):
            return Recording.of(read_journal(path, pause).entries).trajectory()
    return None


def _with_clearance(interval: Interval, times: np.ndarray, clearance: np.ndarray) -> Interval:
    first = np.searchsorted(times, interval.start_s)
    part = clearance[first : np.searchsorted(times, interval.end_s, side="right")]
    least = float(part.min()) if len(part) else np.inf
    return replace(interval, least_clearance_mm=least)


EVENTS = frozenset(
    {
        "phase",
        "touch",
        "undo",
        "trace",
        "stroke",
        "rejected",
        "checkpoint",
        "proximity",
        "camera",
        "plan",
        "registered",
        "aborted",
    }
)
"""Kinds of entries that change the view besides the arm."""


class RecordedEvent(NamedTuple):
    """An entry whose kind is in `EVENTS`, and its trial time in s."""

    time_s: float
    entry: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class ReplayTrack:
    """A recorded trial in trial time, which excludes pauses.

    Attributes:
        q: (n, 7) float, joint angles in rad, one row per sample.
        feed_mm: (n,) float, how far drill or instrument was beyond the guide's tip; 0 without.
    """

    header: Mapping[str, Any]
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
    recording = _ReplayRecording.of(reading.entries)
    trajectory, postures = recording.trajectory(), recording.postures
    if len(postures) < 2 or any(len(posture) != 7 for posture in postures):
        raise InputError(f"{path} has no movement to replay.")
    q, feeds = np.array(postures), np.array(recording.feeds)
    return ReplayTrack(reading.header, trajectory, q, feeds, tuple(recording.events))


class _ReplayRecording(WholeRecording):
    """Also keeps the joint angles of each kept sample, and the events."""

    def __init__(self) -> None:
        super().__init__()
        self.postures: list[list[float]] = []
        self.feeds: list[float] = []
        self.events: list[RecordedEvent] = []

    def add(self, entry: Mapping[str, Any]) -> None:
        known = len(self._samples)
        super().add(entry)
        if len(self._samples) > known:
            self.postures.append([float(value) for value in entry["q"]])
            self.feeds.append(float(entry.get("feedMm", 0.0)))
        if entry["kind"] in EVENTS:
            seen_s = entry["simTimeS"] if self._paused_since is None else self._paused_since
            # Keep events in order, also in the tick in which a trial is paused.
            before_s = self.events[-1].time_s if self.events else 0.0
            self.events.append(RecordedEvent(max(before_s, self._trial_time(seen_s)), entry))
