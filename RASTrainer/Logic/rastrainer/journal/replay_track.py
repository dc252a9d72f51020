"""A trial for replay: its trajectory, joint angles and events."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from rastrainer.errors import InputError
from rastrainer.journal.folder import journals_of
from rastrainer.journal.journal_file import read_journal
from rastrainer.journal.recording import WholeRecording
from rastrainer.motion.trajectory import Trajectory

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
        header: the journal's first entry.
        trajectory: of the tool's tip.
        q: (n, 7) float, joint angles in rad, one row per sample.
        feed_mm: (n,) float, how far drill or instrument was beyond the guide's tip; 0 without.
        events: in order.
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
    """Return the track of a trial from a folder of journals.

    Raises:
        InputError: there is no journal, or it has no movement.
    """
    paths = journals_of(records, trial_id)
    if not paths:
        raise InputError(
            f"The journal of this trial is not in {records}: it can be shown again only on the "
            "computer whose simulator has recorded it."
        )
    return read_track(paths[0])


def read_track(path: Path, pause: Callable[[], None] = lambda: None) -> ReplayTrack:
    """Return the track of a journal, as far as it is intact; `pause` as in `read_journal`.

    Raises:
        InputError: the file is no journal, or has no movement.
    """
    reading = read_journal(path, pause)
    recording = _ReplayRecording.of(reading.entries)
    trajectory, q = recording.trajectory(), np.array(recording.postures, dtype=np.float64)
    if len(q) < 2 or q.shape != (len(trajectory.times_s), 7):
        raise InputError(f"{path} holds no movement that could be shown again.")
    feeds = np.array(recording.feeds, dtype=np.float64)
    return ReplayTrack(reading.header, trajectory, q, feeds, tuple(recording.events))


class _ReplayRecording(WholeRecording):
    """Also keeps the joint angles of each kept sample, and the events."""

    def __init__(self) -> None:
        super().__init__()
        self.postures: list[list[float]] = []
        self.feeds: list[float] = []
        self.events: list[RecordedEvent] = []

    def add(self, entry: Mapping[str, Any]) -> None:
        super().add(entry)
        if entry["kind"] in EVENTS:
            seen_s = entry["simTime"] if self._paused_since is None else self._paused_since
            # Keep events in order, also in the tick in which a trial is paused.
            before_s = self.events[-1].time_s if self.events else 0.0
            self.events.append(RecordedEvent(max(before_s, self._trial_time(seen_s)), entry))

    def _add_sample(self, entry: Mapping[str, Any]) -> bool:
        counts = super()._add_sample(entry)
        if counts:
            self.postures.append(entry["q"])
            self.feeds.append(entry.get("feedMm", 0.0))
        return counts
