"""The entries of one trial's journal, formed tick by tick."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rastrainer.commands import CommandName
from rastrainer.journal.folder import UNNUMBERED, JournalNumber
from rastrainer.journal.journal_file import FORMAT, FORMAT_VERSION, stamp
from rastrainer.journal.recording import Recording
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.protocol import PROCEDURE_PHASES, Phase, RegistrationMethod
from rastrainer.scenario.scenario import method_of, task_by_method
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.how_played import MovedBy
from rastrainer_simulator.record.trial_context import (
    DRAWING_REPORTS,
    REAL_TIME,
    NotedReport,
    PlayingSession,
    report_entry,
)
from rastrainer_simulator.record.trial_records import TrialRecords, UnmeasuredRecord
from rastrainer_simulator.state import (
    Event,
    EventKind,
    Motion,
    OperatorCommand,
    OperatorInput,
    SimulationState,
    StartingPoint,
    StepResult,
)
from rastrainer_simulator.training.trial_start import DRAWN_SEED
from rastrainer_simulator.trial_state import Tool

if TYPE_CHECKING:
    from rastrainer_simulator.core.simulation import Simulation

SAMPLE_HZ = 50.0
MUST_LAST = frozenset(
    {
        EventKind.PHASE,
        EventKind.REGISTRATION,
        EventKind.TOUCH,
        EventKind.UNDO,
        EventKind.STROKE,
        EventKind.CHECKPOINT,
    }
)
"""Events that are not published before they are on the disk."""

_KIND_OF_PHASE = {Phase.REGISTERED: "registered", Phase.IDLE: "aborted"}
_SAMPLED = (Phase.RUNNING, Phase.COMPLETE, *PROCEDURE_PHASES)
_TOUCHED = (EventKind.TOUCH.value, EventKind.CHECKPOINT.value)
_DATED = (*_TOUCHED, EventKind.TRACE.value)
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

    def __init__(self, simulation: Simulation, trial_id: str, started_utc: str, dt: float) -> None:
        """Prepare the entries of the simulation's trial; use `started` or `resumed` instead."""
        self.trial_id = trial_id
        self._seed = simulation.trial_seed
        self.records = TrialRecords(simulation, started_utc)
        self._every = max(1, round(1.0 / (SAMPLE_HZ * dt)))
        self._sticks: tuple[Any, ...] | None = None
        self._trajectory = hashlib.sha256()
        self._recording = Recording()
        self._moved_by = ""
        self.pending: list[dict[str, Any]] = []

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
        times = stamp(state.tick, state.sim_time)
        entries = cls(simulation, training.trial_id, times["utc"], dt)
        entries.records.number = number
        procedure = "" if training.procedure is None else training.procedure.name
        recorded = simulation.setup.recorded(procedure, training.method)
        entries._append(
            {
                "kind": "header",
                "format": FORMAT,
                "version": FORMAT_VERSION,
                **record_to_json(number, with_defaults=True),
                **times,
                "trialId": training.trial_id,
                "trainee": training.trainee,
                "task": training.task,
                "shortestPathMm": task.shortest_path_mm,
                "mode": training.mode,
                "tickS": dt,
                "session": record_to_json(session, with_defaults=True),
                "before": record_to_json(StartingPoint.after(before), with_defaults=True),
                **record_to_json(recorded),
                "settings": record_to_json(recorded.settings, with_defaults=True),
                "versions": entries.records.versions,
            }
        )
        return entries

    @classmethod
    def resumed(
        cls,
        simulation: Simulation,
        state: SimulationState,
        earlier: Sequence[Mapping[str, Any]],
        since: float,
        dt: float,
        session: PlayingSession = REAL_TIME,
    ) -> TrialEntries:
        """Continue from a state of a trial that was interrupted.

        `earlier` are its entries before; since their last one, at the simulated time `since` in s,
        the trial's time is stopped.
        """
        training = state.training
        entries = cls(simulation, training.trial_id, earlier[0]["utc"], dt)
        records = entries.records
        records.number = record_from_json(JournalNumber, earlier[0])
        for entry in earlier:
            entries._collect(entry)
            kind = entry["kind"]
            if kind in _TOUCHED:
                records.dates[entry["simTimeS"] - dt] = entry["utc"]
            elif kind == EventKind.TRACE.value:
                records.dates[entry["simTimeS"]] = entry["utc"]
            elif kind in DRAWING_REPORTS:
                report = record_from_json(DRAWING_REPORTS[kind], entry, f"The entry {kind}")
                records.display.add(report)
        entries._append(
            {
                "kind": "continued",
                **stamp(state.tick, state.sim_time),
                "sinceS": since,
                "session": record_to_json(session, with_defaults=True),
                "camera": state.camera,
                "phase": training.phase.value,
                "kept": len(training.touches),
                "nextPoint": training.next_point,
                "versions": entries.records.versions,
            }
        )
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
        times = stamp(state.tick, state.sim_time)
        if sticks != self._sticks:
            self._sticks = sticks
            self._append(
                {
                    "kind": "input",
                    **times,
                    "translation": operator_input.translation,
                    "rotation": operator_input.rotation,
                    "fine": operator_input.fine,
                    "operator": operator_input.operator,
                }
            )
        for command in operator_input.commands:
            self._append(self._command_entry(times, command))
        registered = None
        for event in result.events:
            if event.kind.value in _DATED:
                self.records.dates[event.sim_time] = times["utc"]
            entry = self._event_entry(times, event)
            if entry["kind"] == "registered":
                entry["truth"] = record_to_json(simulation.truth)
                registered = entry
            self._append(entry)
        if is_sampled:
            self._append_sample(times, state)
        if registered is None:
            return None
        # Of the whole tick: the tip may have touched the head after the command in it.
        record = self.records.registered(state)
        return UnmeasuredRecord(record, self._recording.trajectory(), registered)

    def add_display(self, report: NotedReport, state: SimulationState) -> None:
        self.records.display.add(report)
        self._append(report_entry(report) | stamp(state.tick, state.sim_time))

    def _append(self, entry: dict[str, Any]) -> None:
        self.pending.append(entry)
        self._collect(entry)

    def _collect(self, entry: Mapping[str, Any]) -> None:
        self._recording.add(entry)
        self.records.feeds.add(entry)
        self.records.play.add(entry)

    def _append_sample(self, times: dict[str, Any], state: SimulationState) -> None:
        entry = {
            "kind": "sample",
            **times,
            "q": state.q,
            "tipMm": [MM_PER_M * float(value) for value in state.tool_tip_to_world[:3, 3]],
            "clearanceMm": MM_PER_M * state.clearance,
            "depthMm": MM_PER_M * state.depth,
        }
        if state.tool in (Tool.DRILL, Tool.ELECTRODE):
            entry["feedMm"] = MM_PER_M * state.feed
        self._append({**entry, "movedBy": self._moved_by})
        self._moved_by = ""

    def motion(self) -> dict[str, float]:
        return trial_motion(self._recording.trajectory())

    def taken(self) -> list[dict[str, Any]]:
        taken, self.pending = self.pending, []
        return taken

    def _command_entry(self, times: dict[str, Any], command: OperatorCommand) -> dict[str, Any]:
        arguments = dict(command.arguments)
        if command.name == CommandName.START_TASK:
            arguments["trialId"] = self.trial_id
            arguments.pop(DRAWN_SEED, None)
            # As in journals older than procedures, methods and shifts of the skin.
            for later in ("procedure", "skin"):
                if not arguments.get(later):
                    arguments.pop(later, None)
            if method_of(arguments.get("method")) is RegistrationMethod.FIDUCIALS:
                arguments.pop("method", None)
        return {
            "kind": "command",
            **times,
            "name": command.name,
            "arguments": arguments,
            "sender": command.sender,
        }

    def _event_entry(self, times: dict[str, Any], event: Event) -> dict[str, Any]:
        kind = event.kind.value
        if event.kind is EventKind.PHASE:
            kind = _KIND_OF_PHASE.get(Phase(event.data["phase"]), kind)
        entry = {"kind": kind, **times, **event.data}
        if kind in _KIND_OF_PHASE.values():
            # Until then it is as secret as the head's pose.
            entry["seed"] = self._seed
        if event.kind in MUST_LAST:
            entry["trajectorySha256"] = self._trajectory.hexdigest()
        return entry
