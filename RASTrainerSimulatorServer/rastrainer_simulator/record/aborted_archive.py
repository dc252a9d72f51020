"""The aborted trials in a folder of journals that are still to be delivered.

A trial that was interrupted by the end of the simulator and never resumed counts as aborted:
otherwise ending the simulator would be a way to discard a bad trial.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rastrainer.commands import CommandName
from rastrainer.errors import InputError
from rastrainer.journal.folder import JournalNumber
from rastrainer.journal.journal_file import Integrity, JournalReading, read_journal, stamp
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
from rastrainer_simulator.record.journal_writer import Journal

ATTEMPT = "attempt"
"""Kind of the entry that holds the record of an aborted trial."""


@dataclass(frozen=True)
class ArchivedAttempt:
    """An aborted trial, and whether a client has acknowledged its record."""

    record: AbortedTrial
    acknowledged: bool = False

    def summary(self) -> dict[str, Any]:
        """Return the data of GetTrial; the head's pose in an aborted trial is never revealed."""
        return {
            "trialId": self.record.trial_id,
            "phase": "aborted",
            "record": record_to_json(self.record),
            "acknowledged": self.acknowledged,
        }


class AbortedArchive:
    """Holds the undelivered aborted trials, and answers commands about any aborted one."""

    def __init__(self) -> None:
        self._waiting: dict[str, tuple[ArchivedAttempt, Journal]] = {}

    def unacknowledged(self) -> tuple[AbortedTrial, ...]:
        """Return the records that no client has acknowledged, the oldest first."""
        return tuple(attempt.record for attempt, _journal in list(self._waiting.values()))

    def add(self, record: AbortedTrial, journal: Journal) -> None:
        self._waiting[record.trial_id] = ArchivedAttempt(record), journal

    def add_interrupted(self, path: Path) -> None:
        """Close the journal of an interrupted trial, and add the trial.

        Raises:
            RecordError: it cannot be written.
        """
        reading = read_journal(path)
        if reading.integrity is Integrity.ALTERED:
            raise InputError(f"{path} is {reading.sentence}; its trial is not delivered.")
        record = interrupted_attempt(reading)
        if record is None:
            return
        journal, last = Journal.reopened(reading), reading.entries[-1]
        entry = attempt_entry(record, stamp(last["tick"], last["simTimeS"]))
        _append(journal, {**entry, "seed": reading.header["seed"]})
        self.add(record, journal)

    def load(self, reading: JournalReading) -> bool:
        """Load a journal; return whether its trial was aborted."""
        attempt = _archived_attempt(reading)
        if attempt is None:
            return False
        if not attempt.acknowledged:
            self._waiting[attempt.record.trial_id] = attempt, Journal.reopened(reading)
        return True

    def answer(
        self,
        trial_id: str,
        command: str,
        times: Mapping[str, Any],
        find: Callable[[], JournalReading | None],
    ) -> dict[str, Any] | None:
        """Carry out GetTrial or AcknowledgeTrial; None if the trial is not an aborted one.

        Args:
            trial_id: Of the trial.
            command: Its name.
            times: Stamps of the entry that is appended to the journal.
            find: Reads the trial's journal; None if there is none.

        Raises:
            RecordError: its journal cannot be written.
        """
        waiting = self._waiting.get(trial_id)
        if waiting is None:
            reading = find()
            attempt = None if reading is None else _archived_attempt(reading)
        else:
            attempt = waiting[0]
        if attempt is None:
            return None
        if command == CommandName.GET_TRIAL:
            return attempt.summary()
        if command != CommandName.ACKNOWLEDGE_TRIAL:
            raise InputError(f"The trial {trial_id} was aborted; it has no score.")
        if waiting is not None:
            _append(waiting[1], {"kind": "acknowledged", **times})
            del self._waiting[trial_id]
        return {"trialId": trial_id}


def attempt_entry(record: AbortedTrial, times: Mapping[str, Any]) -> dict[str, Any]:
    return {"kind": ATTEMPT, **times, "record": record_to_json(record)}


def _archived_attempt(reading: JournalReading) -> ArchivedAttempt | None:
    found = reading.of_kind(ATTEMPT)
    if not found or reading.of_kind("registered"):
        return None
    record = record_from_json(AbortedTrial, found[-1].get("record"))
    return ArchivedAttempt(record, bool(reading.of_kind("acknowledged")))


def _append(journal: Journal, entry: Mapping[str, Any]) -> None:
    try:
        journal.write([entry], sync=True)
    finally:
        journal.close()


def interrupted_attempt(reading: JournalReading) -> AbortedTrial | None:
    """Return the record of the trial of an open journal; None if the trial is over."""
    if not reading.entries or InterruptedTrial.of(reading.entries) is None:
        return None
    with refusing_malformed(MALFORMED):
        return _interrupted_attempt(reading.entries)


def _measured_mm(touch: Mapping[str, Any]) -> tuple[float, float, float]:
    """Return where a touch was measured: where the tip was, unless the skin had shifted."""
    x, y, z = touch.get("measuredMm", touch["positionMm"])
    return x, y, z


def _interrupted_attempt(entries: tuple[Mapping[str, Any], ...]) -> AbortedTrial:
    header, trajectory = entries[0], WholeRecording.of(entries).trajectory()
    touches = {entry["label"]: entry for entry in entries if entry["kind"] == "touch"}
    points = tuple(
        TouchedPoint(
            label=touch.label,
            position_mm=_measured_mm(touches[touch.label]),
            sim_time_s=touches[touch.label]["simTimeS"] - header["tickS"],
            utc=touches[touch.label]["utc"],
        )
        for touch in trajectory.touches
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
