"""Write the journal of the running trial in a separate thread."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rastrainer.commands import CommandName
from rastrainer.journal.entries import (
    REAL_TIME,
    Attempt,
    Line,
    PlayingSession,
    Report,
    Stamp,
    Stopped,
)
from rastrainer.journal.folder import UNNUMBERED, newest_journal, number_of
from rastrainer.journal.journal_file import JournalReading, file_stamp
from rastrainer.json_records import record_to_json
from rastrainer.protocol import AbortReason, Phase
from rastrainer_simulator.record.journal_writer import Journal
from rastrainer_simulator.record.trial_archive import SUFFIX, ArchivedTrial, TrialArchive
from rastrainer_simulator.record.trial_entries import MUST_LAST, TrialEntries
from rastrainer_simulator.record.trial_records import UnmeasuredRecord, with_record
from rastrainer_simulator.state import OperatorInput, SimulationState, StepResult
from rastrainer_simulator.training.rules import ENDING_A_TRIAL, RECORDING_FAILED

if TYPE_CHECKING:
    from rastrainer_simulator.core.simulation import Simulation

FLUSH_TICKS = 50
"""Number of ticks after which entries that no client waits for are written."""


@dataclass(frozen=True)
class Written:
    """A write in progress.

    `future` fails if the disk does; with `is_awaited` the tick is not published before it is done.
    """

    future: Future[Any]
    is_awaited: bool


@dataclass
class _OpenTrial:
    """The trial that is recorded: its entries, and the journal that they are written to.

    `registering` writes its registration, None before; if it `is_stuck`, entries that could not be
    written wait until the trainee resumes.
    """

    entries: TrialEntries
    journal: Journal
    registering: Future[Any] | None = None
    is_stuck: bool = False

    @property
    def is_registered(self) -> bool:
        future = self.registering
        return future is not None and future.done() and future.exception() is None


class TrialRecorder:
    """Writes the journal of the present trial.

    `record` and `stop` belong to the control loop's thread and never touch the disk: the entries
    are formed there and written by `writer`, a pool of one thread.
    """

    def __init__(
        self,
        folder: Path,
        archive: TrialArchive,
        writer: ThreadPoolExecutor,
        dt: float,
        session: PlayingSession = REAL_TIME,
    ) -> None:
        self._folder = folder
        self._archive = archive
        self._writer = writer
        self._dt = dt
        self._session = session
        self._open: _OpenTrial | None = None
        self._waiting: tuple[JournalReading, float] | None = None
        newest = newest_journal(folder)
        self._interrupted = newest
        self._numbered = UNNUMBERED if newest is None else number_of(newest)

    def resume_trial(self, simulation: Simulation, reading: JournalReading) -> None:
        """Append to the journal of the trial that the simulation has just resumed.

        While the trial is paused the file stays as it is.
        """
        state = simulation.state
        self._interrupted = None
        self._waiting = reading, state.sim_time
        if state.training.phase is not Phase.PAUSED:
            self._resume(simulation, state)

    def record(
        self,
        simulation: Simulation,
        before: SimulationState,
        operator_input: OperatorInput,
        result: StepResult,
    ) -> Written | None:
        """Record a tick that led from `before` to `result`; return its write, if any."""
        training = result.state.training
        if training.trial_id and training.trial_id != before.training.trial_id:
            self._start(simulation, before, result)
        is_lasting = any(isinstance(event.entry, MUST_LAST) for event in result.events)
        if self._waiting is not None and is_lasting:
            self._resume(simulation, before)
        trial = self._open
        if trial is None:
            return None
        if any(command.name == RECORDING_FAILED for command in operator_input.commands):
            self._keep_refused(trial, simulation, operator_input, result)
            return None
        if trial.is_registered:
            # Nothing but the final registration or the score comes after the record.
            if not is_lasting:
                return None
            ending = [c for c in operator_input.commands if c.name in ENDING_A_TRIAL][-1]
            at = Stamp.now(result.state.tick, result.state.sim_time)
            answer = self._archive.answer
            future = self._writer.submit(answer, ending.name, ending.arguments, at, ending.sender)
            return Written(future, is_awaited=True)
        record = trial.entries.add(simulation, operator_input, result)
        if record is not None:
            return self._register(trial, simulation, record)
        if training.phase is Phase.IDLE:
            return self._abort(trial, before, operator_input, result)
        if is_lasting:
            trial.is_stuck = False
            return self._submit(trial, is_awaited=True)
        is_due = trial.entries.pending and result.state.tick % FLUSH_TICKS == 0
        return self._submit(trial, is_awaited=False) if is_due and not trial.is_stuck else None

    def note_display(self, report: Report, state: SimulationState) -> None:
        if self._open is not None and self._open.registering is None:
            self._open.entries.add_display(report, state)

    def stop(self, state: SimulationState) -> None:
        """Write the remaining entries; a trial that is still open is marked as stopped."""
        trial = self._open
        if trial is None or trial.registering is not None:
            return
        trial.entries.pending.append(Line(Stamp.now(state.tick, state.sim_time), Stopped()))
        self._submit(trial, is_awaited=False)
        self._end(trial.journal.close)

    def _start(self, simulation: Simulation, before: SimulationState, result: StepResult) -> None:
        if self._interrupted is not None:
            # Before the new journal exists: if there are two, the older trial is over.
            self._writer.submit(self._archive.add_interrupted, self._interrupted)
            self._interrupted = None
        self._numbered = self._numbered.following()
        entries = TrialEntries.started(
            simulation, before, result, self._dt, self._numbered, self._session
        )
        name = f"{file_stamp(entries.records.started_utc)}_{entries.trial_id}{SUFFIX}"
        self._open = _OpenTrial(entries, Journal(self._folder / name, simulation.trial_seed))

    def _resume(self, simulation: Simulation, state: SimulationState) -> None:
        assert self._waiting is not None
        (reading, since), self._waiting = self._waiting, None
        entries = TrialEntries.resumed(
            simulation, state, tuple(reading.lines()), since, self._dt, self._session
        )
        self._open = _OpenTrial(entries, Journal.reopened(reading))

    def _keep_refused(
        self,
        trial: _OpenTrial,
        simulation: Simulation,
        operator_input: OperatorInput,
        result: StepResult,
    ) -> None:
        """Keep the entries that could not be written until the trainee resumes.

        Nothing is left of a trial whose start was refused, even if later entries were written.
        """
        phase = result.state.training.phase
        if phase is Phase.IDLE:
            self._end(trial.journal.discard)
            # Its number is free again: a gap would look like a trial that vanished.
            self._numbered = replace(self._numbered, number=self._numbered.number - 1)
        elif not trial.is_registered:
            trial.registering = None
            trial.is_stuck = True
            trial.entries.add(simulation, operator_input, result)

    def _submit(self, trial: _OpenTrial, is_awaited: bool) -> Written:
        lines = trial.entries.taken()
        future = self._writer.submit(trial.journal.write_lines, lines, sync=is_awaited)
        return Written(future, is_awaited)

    def _register(
        self, trial: _OpenTrial, simulation: Simulation, record: UnmeasuredRecord
    ) -> Written:
        truth, seed = simulation.truth, simulation.trial_seed
        journal, lines = trial.journal, trial.entries.taken()

        def write() -> None:
            measured = record.measured(self._archive.was_played)
            journal.write_lines(with_record(lines, measured), sync=True)
            journal.close()
            sealed = replace(measured, journal_sha256=journal.last_hash)
            self._archive.add(ArchivedTrial(sealed, journal, truth, seed))

        trial.registering = self._writer.submit(write)
        return Written(trial.registering, is_awaited=True)

    def _abort(
        self,
        trial: _OpenTrial,
        before: SimulationState,
        operator_input: OperatorInput,
        result: StepResult,
    ) -> Written:
        """Store the record of the aborted trial.

        It is offered even if it cannot be written: the journal writes it with the next entry.
        """
        at = Stamp.now(result.state.tick, result.state.sim_time)
        given = [c for c in operator_input.commands if c.name == CommandName.ABORT]
        reason = given[-1].arguments.get("reason") if given else None
        record = trial.entries.records.aborted(before, reason or AbortReason.CLIENT.value, at.utc)
        trial.entries.pending.append(Line(at, Attempt(record_to_json(record))))
        journal, lines = trial.journal, trial.entries.taken()

        def write() -> None:
            try:
                journal.write_lines(lines, sync=True)
            finally:
                self._archive.add(ArchivedTrial(record, journal))

        written = Written(self._writer.submit(write), is_awaited=False)
        self._end(trial.journal.close)
        return written

    def _end(self, leave: Callable[[], None]) -> None:
        self._writer.submit(leave)
        self._open = None
