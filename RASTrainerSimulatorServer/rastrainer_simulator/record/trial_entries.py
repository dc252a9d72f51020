"""The entries of one trial's journal, formed tick by tick."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from rastrainer.commands import CommandName
from rastrainer.journal.entries import (
    FORMAT,
    FORMAT_VERSION,
    REAL_TIME,
    Aborted,
    AcceptedCheckpoint,
    AcceptedTouch,
    CommandDone,
    Continued,
    Entry,
    FinalRegistration,
    Input,
    JournalHeader,
    Line,
    PhaseChange,
    PlayingSession,
    Registered,
    Report,
    Sample,
    Stamp,
    Stroke,
    TracePoint,
    TutorialReport,
    Undo,
)
from rastrainer.journal.folder import UNNUMBERED, JournalNumber
from rastrainer.journal.recording import Recording
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.protocol import PROCEDURE_PHASES, Phase, RegistrationMethod
from rastrainer.scenario.scenario import method_of, task_by_method
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.how_played import MovedBy
from rastrainer_simulator.record.trial_context import TutorialOutcome
from rastrainer_simulator.record.trial_records import TrialRecords, UnmeasuredRecord, versions_of
from rastrainer_simulator.state import (
    Motion,
    OperatorCommand,
    OperatorInput,
    SimulationState,
    StepResult,
)
from rastrainer_simulator.training.trial_start import DRAWN_SEED
from rastrainer_simulator.trial_state import Tool
from rastrainer_simulator.vectors import in_millimeters

if TYPE_CHECKING:
    from rastrainer_simulator.core.simulation import Simulation

SAMPLE_HZ = 50.0
MUST_LAST = (PhaseChange, FinalRegistration, AcceptedTouch, Undo, Stroke, AcceptedCheckpoint)
"""Entries that are not published before they are on the disk."""

_SAMPLED = (Phase.RUNNING, Phase.COMPLETE, *PROCEDURE_PHASES)
_Q = struct.Struct("<7d")
_MOVED_BY = {
    Motion.STICK: MovedBy.STICKS.value,
    Motion.ALIGN: MovedBy.ALIGNMENT.value,
    Motion.JOG: MovedBy.COMMANDS.value,
    Motion.MOVE: MovedBy.COMMANDS.value,
}
_COUNTS = ("", *dict.fromkeys(_MOVED_BY.values()))
"""The last of those that moved the tip since the last sample counts."""


class TrialEntries:
    """The entries of one trial; those that are `pending` are not submitted to the writer yet."""

    def __init__(
        self, simulation: Simulation, header: JournalHeader, started_utc: str, dt: float
    ) -> None:
        """Prepare the entries of the simulation's trial; use `started` or `resumed` instead."""
        self.trial_id = header.trial_id
        self._seed = simulation.trial_seed
        self.records = TrialRecords(simulation, header, started_utc)
        self._every = max(1, round(1.0 / (SAMPLE_HZ * dt)))
        self._sticks: tuple[Any, ...] | None = None
        self._trajectory = hashlib.sha256()
        self._recording = Recording()
        self._moved_by = ""
        self.pending: list[Line] = []

    @classmethod
    def started(
        cls,
        simulation: Simulation,
        before: SimulationState,
        result: StepResult,
        dt: float,
        number: JournalNumber = UNNUMBERED,
        session: PlayingSession = REAL_TIME,
    ) -> TrialEntries:
        """Start with the header; `before` is the state in which StartTask was carried out.

        `session` is what the simulator was started with.
        """
        state = result.state
        training = state.training
        task = task_by_method(simulation.setup.scenario, training.task, training.method)
        at = Stamp.now(state.tick, state.sim_time)
        procedure = "" if training.procedure is None else training.procedure.name
        header = JournalHeader(
            format=FORMAT,
            version=FORMAT_VERSION,
            number=number.number,
            series=number.series,
            trial_id=training.trial_id,
            trainee=training.trainee,
            task=training.task,
            shortest_path_mm=task.shortest_path_mm,
            mode=training.mode,
            tick_s=dt,
            session=session,
            before=before.starting_point,
            versions=versions_of(simulation),
            **simulation.setup.recorded(procedure, training.method),
        )
        entries = cls(simulation, header, at.utc, dt)
        entries._append(at, header)
        return entries

    @classmethod
    def resumed(
        cls,
        simulation: Simulation,
        state: SimulationState,
        earlier: Sequence[Line],
        since: float,
        dt: float,
        session: PlayingSession = REAL_TIME,
    ) -> TrialEntries:
        """Continue from a state of a trial that was interrupted.

        `earlier` are its lines before; since their last one, at the simulated time `since` in s,
        the trial's time is stopped.
        """
        training, header = state.training, earlier[0].entry
        assert isinstance(header, JournalHeader), "a journal begins with one"
        entries = cls(simulation, header, earlier[0].at.utc, dt)
        records = entries.records
        for line in earlier:
            entries._collect(line)
            if isinstance(line.entry, AcceptedTouch | AcceptedCheckpoint):
                records.dates[line.at.sim_time_s - dt] = line.at.utc
            elif isinstance(line.entry, TracePoint):
                records.dates[line.at.sim_time_s] = line.at.utc
            elif isinstance(line.entry, Report):
                records.reports.append(line.entry)
        continued = Continued(
            since_s=since,
            session=session,
            camera=state.camera,
            phase=training.phase,
            kept=len(training.touches),
            next_point=training.next_point,
            versions=records.versions,
        )
        entries._append(Stamp.now(state.tick, state.sim_time), continued)
        return entries

    def add(
        self, simulation: Simulation, operator_input: OperatorInput, result: StepResult
    ) -> UnmeasuredRecord | None:
        """Record one tick; return the trial's record when it has just been registered.

        It has to be measured before the entries are written.
        """
        state = result.state
        sticks = (operator_input.translation, operator_input.rotation, operator_input.fine)
        self._trajectory.update(_Q.pack(*state.q))
        self._moved_by = max(self._moved_by, _MOVED_BY.get(state.motion, ""), key=_COUNTS.index)
        is_sampled = state.training.phase in _SAMPLED and state.tick % self._every == 0
        quiet = sticks == self._sticks and not operator_input.commands and not result.events
        if quiet and not is_sampled:
            return None
        at = Stamp.now(state.tick, state.sim_time)
        if sticks != self._sticks:
            self._sticks = sticks
            self._append(at, Input(*sticks, operator_input.operator))
        for command in operator_input.commands:
            self._append(at, self._command_entry(command))
        is_registered = False
        for event in result.events:
            if isinstance(event.entry, AcceptedTouch | AcceptedCheckpoint | TracePoint):
                self.records.dates[event.sim_time] = at.utc
            entry = self._event_entry(event.entry, simulation)
            is_registered = is_registered or isinstance(entry, Registered)
            self._append(at, entry)
        if is_sampled:
            moved_by, self._moved_by = self._moved_by, ""
            is_fed = state.tool in (Tool.DRILL, Tool.ELECTRODE)
            sample = Sample(
                q=state.q,
                tip_mm=in_millimeters(state.tip),
                clearance_mm=MM_PER_M * state.clearance,
                depth_mm=MM_PER_M * state.depth,
                feed_mm=MM_PER_M * state.feed if is_fed else None,
                moved_by=moved_by,
            )
            self._append(at, sample)
        if not is_registered:
            return None
        # The record covers the whole tick: the tip may have touched the head after the command.
        record = self.records.registered(state)
        return UnmeasuredRecord(record, self._seed, self._recording.trajectory())

    def add_display(self, report: Report, state: SimulationState) -> None:
        self.records.reports.append(report)
        if isinstance(report, TutorialOutcome):
            # The rest is in the tutorial's own file.
            names = [each.name for each in fields(TutorialReport)]
            report = TutorialReport(**{name: getattr(report, name) for name in names})
        self._append(Stamp.now(state.tick, state.sim_time), report)

    def _append(self, at: Stamp, entry: Entry) -> None:
        line = Line(at, entry)
        self.pending.append(line)
        self._collect(line)

    def _collect(self, line: Line) -> None:
        self._recording.add(line)
        self.records.feeds.add(line)
        self.records.play.add(line)

    def motion(self) -> dict[str, float]:
        return trial_motion(self._recording.trajectory())

    def taken(self) -> list[Line]:
        taken, self.pending = self.pending, []
        return taken

    def _command_entry(self, command: OperatorCommand) -> CommandDone:
        arguments = dict(command.arguments)
        if command.name == CommandName.START_TASK:
            arguments["trialId"] = self.trial_id
            arguments.pop(DRAWN_SEED, None)
            # They say nothing about a trial of fiducials alone.
            for later in ("procedure", "skin"):
                if not arguments.get(later):
                    arguments.pop(later, None)
            if method_of(arguments.get("method")) is RegistrationMethod.FIDUCIALS:
                arguments.pop("method", None)
        return CommandDone(command.name, arguments, command.sender)

    def _event_entry(self, entry: Entry, simulation: Simulation) -> Entry:
        if isinstance(entry, PhaseChange) and entry.phase in (Phase.REGISTERED, Phase.IDLE):
            # Until then the seed is as secret as the head's pose.
            state = {**vars(entry), "seed": self._seed}
            if entry.phase is Phase.IDLE:
                entry = Aborted(**state)
            else:
                entry = Registered(**state, truth=simulation.truth)
        if isinstance(entry, PhaseChange | AcceptedTouch | Undo | Stroke | AcceptedCheckpoint):
            return replace(entry, trajectory_sha256=self._trajectory.hexdigest())
        return entry
