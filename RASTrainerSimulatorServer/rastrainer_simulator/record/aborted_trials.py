"""The records of aborted trials.

A trial that was interrupted by the end of the simulator and never resumed counts as aborted:
otherwise ending the simulator would be a way to discard a bad trial.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rastrainer.journal.folder import JournalNumber
from rastrainer.journal.journal_file import JournalReading
from rastrainer.journal.recording import WholeRecording
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import PROCEDURE_PHASES, AbortReason, Phase
from rastrainer.scenario.scenario import method_of
from rastrainer.trial.aborted_trial import AbortedTrial
from rastrainer.trial.record import TouchedPoint
from rastrainer_simulator.core.interrupted_trial import (
    MALFORMED,
    InterruptedTrial,
    refusing_malformed,
)
from rastrainer_simulator.vectors import vector

ATTEMPT = "attempt"
"""Kind of the entry that holds the record of an aborted trial."""


@dataclass(frozen=True)
class ArchivedAttempt:
    """An aborted trial, and whether a client has acknowledged its record."""

    record: AbortedTrial
    acknowledged: bool = False

    @property
    def is_settled(self) -> bool:
        """Whether nothing more is expected."""
        return self.acknowledged

    def summary(self) -> dict[str, Any]:
        """Return the data of GetTrial; the head's pose in an aborted trial is never revealed."""
        return {
            "trialId": self.record.trial_id,
            "phase": "aborted",
            "record": record_to_json(self.record),
            "acknowledged": self.acknowledged,
        }


def attempt_entry(record: AbortedTrial, times: Mapping[str, Any]) -> dict[str, Any]:
    return {"kind": ATTEMPT, **times, "record": record_to_json(record)}


def archived_attempt(reading: JournalReading) -> ArchivedAttempt | None:
    """Return the trial of a journal, None if it was not aborted."""
    found = reading.of_kind(ATTEMPT)
    if not found or reading.of_kind("registered"):
        return None
    record = record_from_json(AbortedTrial, found[-1].get("record"))
    return ArchivedAttempt(record, bool(reading.of_kind("acknowledged")))


def interrupted_attempt(reading: JournalReading) -> AbortedTrial | None:
    """Return the record of the trial of an open journal; None if the trial is over."""
    if not reading.entries or InterruptedTrial.of(reading.entries) is None:
        return None
    with refusing_malformed(MALFORMED):
        return _interrupted_attempt(reading.entries)


def _interrupted_attempt(entries: tuple[Mapping[str, Any], ...]) -> AbortedTrial:
    header, trajectory = entries[0], WholeRecording.of(entries).trajectory()
    touches = {entry["label"]: entry for entry in entries if entry["kind"] == "touch"}
    points = tuple(
        TouchedPoint(
            label=touch["label"],
            # Where the tip was, unless the skin had shifted.
            position_mm=vector(touch.get("measuredMm", touch["positionMm"])),
            sim_time_s=touch["simTimeS"] - header["tickS"],
            utc=touch["utc"],
        )
        for touch in (touches[each.label] for each in trajectory.touches)
    )
    phases = [entry["phase"] for entry in entries if entry["kind"] in ("phase", "continued")]
    stage = next((phase for phase in reversed(phases) if phase != Phase.PAUSED.value), "")
    # A procedure that is paused is aborted in what it was paused in.
    phase = stage if stage in {phase.value for phase in PROCEDURE_PHASES} else phases[-1]
    if phase == Phase.COMPLETE.value:
        elapsed_s = trajectory.intended[-1].time_s
    else:
        # Samples are taken while the trial's time runs.
        elapsed_s = float(trajectory.times_s[-1]) if len(trajectory.times_s) else 0.0
    number = record_from_json(JournalNumber, header)
    record = AbortedTrial(
        trial_id=header["trialId"],
        trainee=header["trainee"],
        task=header["task"],
        mode=header["mode"],
        scenario=header["scenario"]["name"],
        started_utc=header["utc"],
        aborted_utc=entries[-1]["utc"],
        elapsed_s=elapsed_s,
        phase=phase,
        reason=AbortReason.ABANDONED.value,
        points=points,
        rejected_touches=len(trajectory.refused),
        undone_touches=trajectory.undone,
        versions=header["versions"],
        touch_rule=header["settings"]["training"]["touchRule"],
        method=method_of(header["method"]["name"] if "method" in header else None),
        traced=len(trajectory.traced),
        number=number.number,
        series=number.series,
    )
    return record_from_json(AbortedTrial, record_to_json(record))
