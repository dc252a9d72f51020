"""The trials and drills in a folder of journals, with those that are still to be delivered."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.commands import CommandName
from rastrainer.decision.drill_record import DrillRecord
from rastrainer.errors import InputError, RASTrainerError
from rastrainer.journal.entries import (
    AcceptedTouch,
    Acknowledged,
    Attempt,
    CaseClock,
    CaseDecided,
    CheckedPlace,
    Continued,
    Entry,
    FinalRegistration,
    JournalHeader,
    Line,
    PhaseChange,
    Scored,
    Stamp,
    read_line,
)
from rastrainer.journal.folder import DRILL_SUFFIX, SUFFIX, journal_names, journals_of
from rastrainer.journal.journal_file import Integrity, JournalReading, read_journal
from rastrainer.journal.recording import WholeRecording
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.procedure.record import UsedRegistration
from rastrainer.protocol import DECIDE, PROCEDURE_PHASES, AbortReason, Phase
from rastrainer.trial.record import AbortedTrial, TouchedPoint, TrialRecord
from rastrainer_simulator.core.interrupted_trial import (
    InterruptedTrial,
    refusing_malformed,
)
from rastrainer_simulator.record.journal_writer import Journal
from rastrainer_simulator.record.trial_records import of_header
from rastrainer_simulator.texts.texts import say
from rastrainer_simulator.training.head_pose import Truth

FIRST_REACH = 1 << 16
"""Bytes at the end of a journal that are read first."""

JOURNAL_PIECE_BYTES = 1 << 18
"""Longest part of a journal in one answer."""

_KIND = re.compile(rb'^\{"n":\d+,"previous":"[0-9a-f]{64}","kind":"([a-z]+)"', re.MULTILINE)
_DELIVERED = frozenset({b"registered", b"attempt", b"drill"})
_OVER = _DELIVERED | {b"aborted"}
_AFTER_THE_TRIAL = _DELIVERED | {b"registration", b"scored", b"acknowledged"}


DeliveredRecord = TrialRecord | AbortedTrial | DrillRecord


@dataclass(frozen=True)
class ArchivedTrial:
    """A registered or aborted trial, or a drill of decisions.

    `truth` and `seed` are revealed with the registration, and None, never revealed, of an aborted
    trial; a drill has none. `registration` and `scored` are the arguments of their commands, None
    before.
    """

    record: DeliveredRecord
    journal: Journal
    truth: Truth | None = None
    seed: int | None = None
    registration: Mapping[str, Any] | None = None
    scored: Mapping[str, Any] | None = None
    acknowledged: bool = False

    def summary(self) -> dict[str, Any]:
        """Return the data of GetTrial: with the truth if a registration was submitted."""
        phase = "registered" if self.scored is None else "scored"
        if self.truth is None:
            phase = "decided" if isinstance(self.record, DrillRecord) else "aborted"
        data: dict[str, Any] = {
            "trialId": self.record.trial_id,
            "phase": phase,
            "record": record_to_json(self.record),
            "acknowledged": self.acknowledged,
        }
        if self.registration is None:
            return data
        return {**data, "seed": self.seed, **self.revealed()}

    def revealed(self) -> dict[str, Any]:
        if self.registration is None or self.truth is None:
            raise InputError("No registration of the trial was submitted.")
        assert not isinstance(self.record, DrillRecord), "a drill has no truth"
        touches = ((point.label, point.position_mm) for point in self.record.points)
        return self.truth.revealed(self.registration["matrix"], touches)

    def after(
        self, command: str, arguments: Mapping[str, Any], sender: str
    ) -> tuple[Entry | None, ArchivedTrial]:
        """Return a command's entry, None if it changes nothing, and the trial after it.

        A registration is final, because it reveals the truth.
        """
        if command == CommandName.ACKNOWLEDGE_TRIAL:
            if not self.acknowledged:
                return Acknowledged(sender), replace(self, acknowledged=True)
        elif self.truth is None and command != CommandName.GET_TRIAL:
            what = "is a drill" if isinstance(self.record, DrillRecord) else "was aborted"
            raise InputError(
                f"The trial {self.record.trial_id} {what}; it has no registration and no score."
            )
        elif command == CommandName.SUBMIT_REGISTRATION:
            if self.registration is None:
                return FinalRegistration(sender, arguments), replace(self, registration=arguments)
            kept, given = map(UsedRegistration.from_arguments, (self.registration, arguments))
            if not kept.agrees_with(given):
                raise InputError(say("registration is final"))
        elif command == CommandName.TRIAL_SCORED:
            if self.registration is None:
                raise InputError(say("no registration"))
            if self.scored != arguments:
                return Scored(sender, arguments), replace(self, scored=arguments)
        return None, self


@refusing_malformed()
def interrupted_attempt(reading: JournalReading) -> AbortedTrial | None:
    """Return the record of the trial of an open journal; None if the trial is over.

    A trial that was interrupted by the end of the simulator and never resumed counts as aborted:
    otherwise ending the simulator would be a way to discard a bad trial.
    """
    lines = tuple(reading.lines())
    if lines and reading.header.task == DECIDE:
        return _abandoned(reading.header, lines, _drill_time_s(lines), Phase.RUNNING)
    if not lines or InterruptedTrial.of(lines) is None:
        return None
    header, trajectory = reading.header, WholeRecording.of(lines).trajectory()
    touches = {entry.label: (at, entry) for at, entry in lines if isinstance(entry, AcceptedTouch)}
    points = tuple(
        TouchedPoint(
            label=label,
            # Where the tip was, unless the skin had shifted.
            position_mm=touch.measured_mm or touch.position_mm,
            sim_time_s=at.sim_time_s - header.tick_s,
            utc=at.utc,
        )
        for label, (at, touch) in ((each.label, touches[each.label]) for each in trajectory.touches)
    )
    phases = [line.entry.phase for line in lines if isinstance(line.entry, PhaseChange | Continued)]
    stage = next((phase for phase in reversed(phases) if phase is not Phase.PAUSED), None)
    # A paused procedure is aborted in the phase before the pause.
    phase = stage if stage in PROCEDURE_PHASES else phases[-1]
    if phase is Phase.COMPLETE:
        elapsed_s = trajectory.intended[-1].time_s
    else:
        # Samples are taken while the trial's time runs.
        elapsed_s = float(trajectory.times_s[-1]) if len(trajectory.times_s) else 0.0
    return _abandoned(
        header,
        lines,
        elapsed_s,
        phase,
        points=points,
        rejected_touches=len(trajectory.refused),
        undone_touches=trajectory.undone,
        traced=len(trajectory.traced),
    )


def _drill_time_s(lines: Sequence[Line]) -> float:
    """Return the time of a drill's decided cases and of its present one."""
    decided_s = present_s = 0.0
    for _at, entry in lines:
        if isinstance(entry, CaseDecided):
            decided_s, present_s = decided_s + entry.case["timeS"], 0.0
        elif isinstance(entry, CaseClock | CheckedPlace):
            present_s = entry.time_s
    return decided_s + present_s


def _abandoned(
    header: JournalHeader, lines: Sequence[Line], elapsed_s: float, phase: Phase, **done: Any
) -> AbortedTrial:
    record = AbortedTrial(
        **of_header(header),
        started_utc=lines[0].at.utc,
        aborted_utc=lines[-1].at.utc,
        elapsed_s=elapsed_s,
        phase=phase.value,
        reason=AbortReason.ABANDONED.value,
        versions=header.versions,
        **{"points": (), "rejected_touches": 0, "undone_touches": 0, **done},
    )
    return record_from_json(AbortedTrial, record_to_json(record))


class TrialArchive:
    """The registered and aborted trials of a folder, and its finished drills.

    One thread changes it; any thread may call `unacknowledged`. `problems` are sentences about
    unusable journals; `arrivals` counts the trials that have come to be delivered.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._kept: dict[str, ArchivedTrial] = {}
        self.problems: list[str] = []
        self.arrivals = 0
        for path in find_unacknowledged(folder):
            self._load(path)

    def unacknowledged(self) -> tuple[DeliveredRecord, ...]:
        """Return the records that no client has acknowledged: finished trials after all others.

        The oldest of each kind come first.
        """
        waiting = [trial for trial in list(self._kept.values()) if not trial.acknowledged]
        waiting.sort(key=lambda trial: trial.truth is not None)
        return tuple(trial.record for trial in waiting)

    def was_played(self, seed: int) -> bool:
        revealed = f'"seed":{seed},'.encode()
        return any(revealed in _end(path) for path in self._folder.glob(f"*{SUFFIX}"))

    def add(self, trial: ArchivedTrial) -> None:
        self._kept[trial.record.trial_id] = trial
        self.arrivals += 1

    def add_interrupted(self, path: Path) -> None:
        """Add the trial of a journal that was still open when another trial was started."""
        if not _OVER.isdisjoint(_KIND.findall(_end(path))):
            return
        try:
            reading = read_journal(path)
            if reading.integrity is Integrity.ALTERED:
                raise InputError(f"{path} is {reading.sentence}; its trial is not delivered.")
            record = interrupted_attempt(reading)
            if record is None:
                return
            journal, last = Journal.reopened(reading), read_line(reading.entries[-1]).at
            attempt = Attempt(record_to_json(record), reading.seed)
            journal.append(Stamp.now(last.tick, last.sim_time_s), attempt)
        except RASTrainerError as error:
            self.problems.append(str(error))
        else:
            self.add(ArchivedTrial(record, journal))

    def answer(
        self, command: str, arguments: Mapping[str, Any], at: Stamp, sender: str = ""
    ) -> dict[str, Any]:
        """Carry out a command about one of the trials and return the answer's data.

        `at` is for the entry that is appended to the trial's journal, or RecordError is raised.
        """
        trial_id = arguments["trialId"]
        # As a journal returns them, so that repeated arguments compare equal.
        arguments = json.loads(json.dumps(arguments))
        entry, trial = self._found(trial_id).after(command, arguments, sender)
        if entry is not None:
            trial.journal.append(at, entry)
        # A trial is kept in memory until nothing more is expected.
        is_scored = trial.truth is None or trial.scored is not None
        if trial.acknowledged and is_scored:
            del self._kept[trial_id]
        else:
            self._kept[trial_id] = trial
        if command == CommandName.GET_TRIAL:
            return trial.summary()
        if command == CommandName.GET_JOURNAL:
            return self._journal_piece(trial, arguments["start"])
        if command == CommandName.SUBMIT_REGISTRATION:
            return {"trialId": trial_id, **trial.revealed()}
        return {"trialId": trial_id}

    def _journal_piece(self, trial: ArchivedTrial, start: int) -> dict[str, Any]:
        """Return a piece of a trial's journal, once the truth in it is no secret."""
        if trial.registration is None:
            raise InputError(say("no registration"))
        (path,) = journals_of(self._folder, trial.record.trial_id)
        try:
            with path.open("rb") as file:
                file.seek(start)
                piece = file.read(JOURNAL_PIECE_BYTES)
                is_more = bool(file.read(1))
        except OSError as error:
            raise InputError(f"{path.name} cannot be read: {error.strerror}.") from None
        return {"text": piece.decode("ascii"), "next": start + len(piece) if is_more else None}

    def _found(self, trial_id: str) -> ArchivedTrial:
        if trial_id not in self._kept:
            for suffix in (SUFFIX, DRILL_SUFFIX):
                for path in journals_of(self._folder, trial_id, suffix):
                    self._load(path)
        if trial_id not in self._kept:
            raise InputError(say("no such trial", trial_id=trial_id))
        return self._kept[trial_id]

    def _load(self, path: Path) -> None:
        try:
            trial = archived_trial(read_journal(path))
        except InputError as error:
            self.problems.append(str(error))
        else:
            if trial is not None:
                self.add(trial)


def archived_trial(reading: JournalReading) -> ArchivedTrial | None:
    """Return the trial or drill of a journal, None if it is not over."""
    if reading.integrity is Integrity.ALTERED:
        raise InputError(f"{reading.path} is {reading.sentence}; the trial is not delivered.")
    kinds = ("registered", "attempt", "registration", "scored")
    registered, aborted, registrations, scores = map(reading.of_kind, kinds)
    acknowledged, journal = bool(reading.of_kind("acknowledged")), Journal.reopened(reading)
    for end in reading.of_kind("drill"):
        drill = record_from_json(DrillRecord, end.get("record"))
        drill = replace(drill, journal_sha256=end["sha256"])
        return ArchivedTrial(drill, journal, acknowledged=acknowledged)
    if not registered and not aborted:
        return None
    if not registered:
        attempt = record_from_json(AbortedTrial, aborted[-1].get("record"))
        return ArchivedTrial(attempt, journal, acknowledged=acknowledged)
    try:
        values = registered[-1]
        record = record_from_json(TrialRecord, values.get("record"))
        trial = ArchivedTrial(
            record=replace(record, journal_sha256=values["sha256"]),
            journal=journal,
            truth=record_from_json(Truth, values.get("truth")),
            seed=values["seed"],
            registration=registrations[0]["arguments"] if registrations else None,
            scored=scores[-1]["arguments"] if scores else None,
            acknowledged=acknowledged,
        )
        # Check that the data of GetTrial and SubmitRegistration can be computed.
        replace(trial, registration=trial.registration or {"matrix": np.eye(4)}).summary()
    except (InputError, KeyError, TypeError, ValueError, AttributeError) as error:
        # The content may be invalid despite its hashes: forged, or written by a later version.
        raise InputError(
            f"{reading.path} does not hold a registered trial as it should ({error!r}); it is not "
            "delivered."
        ) from None
    return trial


def find_unacknowledged(folder: Path) -> list[Path]:
    """Return the journals of trials and drills that no client has acknowledged, oldest first.

    Only the end of each file is read: a lab's folder holds thousands.
    """
    found = []
    for path in journal_names(folder):
        kinds = set(_KIND.findall(_end(path)))
        if kinds & _DELIVERED and b"acknowledged" not in kinds:
            found.append(path)
    return found


def _end(path: Path) -> bytes:
    """Return the last lines of a journal, back to before the trial was registered."""
    reach = FIRST_REACH
    try:
        with path.open("rb") as file:
            size = file.seek(0, os.SEEK_END)
            while True:
                file.seek(max(0, size - reach))
                end = file.read(reach)
                if reach >= size or not _AFTER_THE_TRIAL.issuperset(_KIND.findall(end)):
                    return end
                reach *= 4
    except OSError:
        return b""
