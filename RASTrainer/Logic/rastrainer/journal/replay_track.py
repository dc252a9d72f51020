"""A trial to be looked at again: its trajectory, and the arm's posture at each sample."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.journal.folder import journals_of
from rastrainer.journal.journal_reader import read_journal
from rastrainer.journal.recording import Recording
from rastrainer.motion.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class ReplayTrack:
    """What a journal shows of a trial.

    Attributes:
        trajectory: the tool's tip, clearance and touches over the trial's time.
        q: (n, 7) float, joint angles in rad, a row a sample of the trajectory.
    """

    trajectory: Trajectory
    q: np.ndarray


def find_track(records: Path, trial_id: str) -> ReplayTrack:
    """Return the track of a trial whose journal lies in a folder.

    Raises:
        InputError: there is none, or it holds no movement.
    """
    paths = journals_of(records, trial_id)
    if not paths:
        raise InputError(
            f"The journal of this trial is not in {records}: it can be shown again only on the "
            "computer whose simulator has recorded it."
        )
    return read_track(paths[0])


def read_track(path: Path) -> ReplayTrack:
    """Return the track of a journal, as far as it is whole.

    Raises:
        InputError: the file is no journal, or holds no movement.
    """
    recording = _PostureRecording.of(read_journal(path).entries)
    trajectory, q = recording.trajectory(), np.array(recording.postures, dtype=float)
    if len(q) < 2 or q.shape != (len(trajectory.times_s), 7):
        raise InputError(f"{path} holds no movement that could be shown again.")
    return ReplayTrack(trajectory, q)


class _PostureRecording(Recording):
    """Keeps the joint angles beside each sample that counts."""

    def __init__(self) -> None:
        super().__init__()
        self.postures: list[list[float]] = []

    def _add_sample(self, entry: Mapping[str, Any]) -> bool:
        counts = super()._add_sample(entry)
        if counts:
            self.postures.append(entry["q"])
        return counts
