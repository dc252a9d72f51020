"""The record of a trial that has just been registered, before its motion is measured."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from rastrainer.motion.trajectory import Trajectory
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.trial.record import TrialRecord


@dataclass(frozen=True)
class UnmeasuredRecord:
    """What the tick of Register leaves to a thread that has time.

    A long trial's motion metrics take longer than a tick.
    """

    _record: TrialRecord
    _trajectory: Trajectory
    _entry: dict[str, Any]

    def measured(self) -> TrialRecord:
        """Return the record with its motion metrics, and put it into the entry of Register."""
        record = replace(self._record, motion=trial_motion(self._trajectory))
        self._entry["record"] = record.to_json()
        return record
