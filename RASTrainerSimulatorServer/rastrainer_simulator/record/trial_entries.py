"""The entries of one trial's journal, formed tick by tick."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

from rastrainer.journal.journal_file import FORMAT, FORMAT_VERSION
from rastrainer.journal.recording import Recording
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.procedure.record import ProcedureRecord
from rastrainer.protocol import PROCEDURE_PHASES, CommandName, Phase, RegistrationMethod
from rastrainer.scenario.method_task import method_of, task_by_method
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.aborted_trial import AbortedTrial
from rastrainer.trial.record import TouchedPoint, TracePoint, TrialRecord
from rastrainer_simulator.operator_input import OperatorCommand, OperatorInput
from rastrainer_simulator.ops.stamps import stamp
from rastrainer_simulator.procedure_state import Tool
from rastrainer_simulator.record.beside_the_trial import (
    DisplayReport,
    DisplayUse,
    GhostReport,
    GuidanceReport,
    NotedReport,
)
from rastrainer_simulator.record.procedure_entries import FeedRecording, procedure_record
from rastrainer_simulator.record.recorded_setup import versions
from rastrainer_simulator.record.unmeasured_record import UnmeasuredRecord
from rastrainer_simulator.state import (
    Event,
    EventKind,
    SimulationState,
    StartingPoint,
    StepResult,
    TrainingState,
)
from rastrainer_simulator.vectors import in_millimeters

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


class TrialEntries:
    """The entries of one trial; `pending` are those that are not submitted to the writer yet."""

    def __init__(self, simulation: Simulation, trial_id: str, started_utc: str, dt: float) -> None:
        """Prepare the entries of the simulation's trial; use `started` or `resumed` instead."""
        self.trial_id = trial_id
        self.started_utc = started_utc
        self._seed = simulation.trial_seed
        # Its seed is revealed with the truth.
        self._skin = replace(simulation.truth.skin, seed=0)
        self._setup = simulation.setup
        self.versions = versions() | {"kinematics": simulation.kinematics_name}
        self._every = max(1, round(1.0 / (SAMPLE_HZ * dt)))
        self._sticks: tuple[Any, ...] | None = None
        self._trajectory = hashlib.sha256()
        self._utc: dict[float, str] = {}
        self._recording = Recording()
        self._feeds = FeedRecording()
        self._display = DisplayUse()
        self.pending: list[dict[str, Any]] = []

    @classmethod
    def started(
        cls,
        simulation: Simulation,
        before: SimulationState,
        result: StepResult,
        dt: float,
        number: int = 0,
    ) -> TrialEntries:
        """Start with the header; `before` is the state in which StartTask was carried out.

        `number` counts the trials of a folder; where none is recorded it is 0.
        """
        state = result.state
        training = state.training
        task = task_by_method(simulation.setup.scenario, training.task, training.method)
        times = stamp(state.tick, state.sim_time)
        entries = cls(simulation, training.trial_id, times["utc"], dt)
        entries._append(
            {
                "kind": "header",
                "format": FORMAT,
                "version": FORMAT_VERSION,
                "number": number,
                **times,
                "trialId": training.trial_id,
                "trainee": training.trainee,
                "task": training.task,
                "shortestPathMm": task.shortest_path_mm,
                "mode": training.mode,
                "seed": entries._seed,
                "tickS": dt,
                "before": asdict(StartingPoint.after(before)),
                **simulation.setup.description(
                    "" if training.procedure is None else training.procedure.name,
                    training.method,
                ),
                "versions": entries.versions,
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
    ) -> TrialEntries:
        """Go on from a state of a trial that was interrupted.

        `earlier` are its entries before; since their last one, at the simulated time `since` in s,
        the trial's time is stopped.
        """
        training = state.training
        entries = cls(simulation, training.trial_id, earlier[0]["utc"], dt)
        for entry in earlier:
            entries._collect(entry)
            if entry["kind"] in _TOUCHED:
                entries._utc[entry["simTime"] - dt] = entry["utc"]
            elif entry["kind"] == EventKind.TRACE.value:
                entries._utc[entry["simTime"]] = entry["utc"]
            elif entry["kind"] == "display":
                entries._display.add(DisplayReport.of(entry))
            elif entry["kind"] == "guidance":
                entries._display.guidance = entry["guidance"]
            elif entry["kind"] == "ghost":
                entries._display.ghost = entry["ghost"]
        entries._append(
            {
                "kind": "continued",
                **stamp(state.tick, state.sim_time),
                "since": since,
                "camera": state.camera,
                "phase": training.phase.value,
                "kept": len(training.touches),
                "nextPoint": training.next_point,
                "versions": entries.versions,
            }
        )
        return entries

    def add(
        self, simulation: Simulation, operator_input: OperatorInput, result: StepResult
    ) -> UnmeasuredRecord | None:
        """Take note of one tick; return the trial's record when it has just been registered.

        It has to be measured before the entries are written.
        """
        state = result.state
        sticks = (operator_input.translation, operator_input.rotation, operator_input.fine)
        self._trajectory.update(_Q.pack(*state.q))
        is_sampled = state.training.phase in _SAMPLED and state.tick % self._every == 0
        quiet = sticks == self._sticks and not operator_input.commands and not result.events
        if quiet and not is_sampled:
            return None
        times = stamp(state.tick, state.sim_time)
        if sticks != self._sticks:
            self._sticks = sticks
            self._append(_input_entry(times, operator_input))
        for command in operator_input.commands:
            self._append(self._command_entry(times, command))
        registered = None
        for event in result.events:
            if event.kind.value in _DATED:
                self._utc[event.sim_time] = times["utc"]
            entry = self._event_entry(times, event)
            if entry["kind"] == "registered":
                entry["truth"] = simulation.truth.to_json()
                registered = entry
            self._append(entry)
        if is_sampled:
            self._append(_sample_entry(times, state))
        if registered is None:
            return None
        # Of the whole tick: the tip may have touched the head after the command in it.
        return UnmeasuredRecord(self._record(state), self._recording.trajectory(), registered)

    def add_display(self, report: NotedReport, state: SimulationState) -> None:
        """Take note of what is seen, and how: it is recorded, but nothing follows from it."""
        if isinstance(report, DisplayReport):
            self._display.add(report)
        elif isinstance(report, GuidanceReport):
            self._display.guidance = report.guidance
        elif isinstance(report, GhostReport):
            self._display.ghost = report.ghost
        self._append(report.entry() | stamp(state.tick, state.sim_time))

    def _append(self, entry: dict[str, Any]) -> None:
        self.pending.append(entry)
        self._collect(entry)

    def _collect(self, entry: Mapping[str, Any]) -> None:
        self._recording.add(entry)
        self._feeds.add(entry)

    def motion(self) -> dict[str, float]:
        """Return the motion metrics of the trial so far."""
        return trial_motion(self._recording.trajectory())

    def taken(self) -> list[dict[str, Any]]:
        """Return the pending entries and clear them."""
        taken, self.pending = self.pending, []
        return taken

    def _command_entry(self, times: dict[str, Any], command: OperatorCommand) -> dict[str, Any]:
        arguments = dict(command.arguments)
        if command.name == CommandName.START_TASK:
            arguments |= {"seed": self._seed, "trialId": self.trial_id}
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
        if event.kind in MUST_LAST:
            entry["trajectorySha256"] = self._trajectory.hexdigest()
        return entry

    def aborted(self, before: SimulationState, reason: str, utc: str) -> AbortedTrial:
        """Return the record of a trial that was aborted in a state, for a reason, at a time."""
        training = before.training
        stage = training.phase if training.procedure is None else training.procedure.stage
        return AbortedTrial(
            trial_id=training.trial_id,
            trainee=training.trainee,
            task=training.task,
            mode=training.mode,
            scenario=self._setup.scenario.name,
            started_utc=self.started_utc,
            aborted_utc=utc,
            elapsed_s=before.elapsed,
            # A procedure that is paused is aborted in what it was paused in.
            phase=(stage if stage in PROCEDURE_PHASES else training.phase).value,
            reason=reason,
            points=self._points(training),
            rejected_touches=training.rejected,
            undone_touches=training.undone,
            versions=self.versions,
            touch_rule=self._setup.settings.training.touch_rule.value,
            method=training.method,
            traced=0 if training.trace is None else len(training.trace.points),
        )

    def _points(self, training: TrainingState) -> tuple[TouchedPoint, ...]:
        return tuple(
            TouchedPoint(
                label=touch.label,
                position_mm=in_millimeters(touch.position),
                sim_time_s=touch.sim_time,
                utc=self._utc[touch.sim_time],
            )
            for touch in training.touches
        )

    def _record(self, state: SimulationState) -> TrialRecord:
        training = state.training
        points, trace = self._points(training), _trace(training)
        completed = trace[-1][3] if trace else training.touches[-1].sim_time
        return TrialRecord(
            trial_id=training.trial_id,
            trainee=training.trainee,
            task=training.task,
            mode=training.mode,
            scenario=self._setup.scenario.name,
            started_utc=self.started_utc,
            completed_utc=self._utc[completed],
            completion_time_s=training.completed_s,
            points=points,
            rejected_touches=training.rejected,
            undone_touches=training.undone,
            versions=self.versions,
            touch_rule=self._setup.settings.training.touch_rule.value,
            display=self._display.summary(),
            procedure=self._procedure_record(training),
            method=training.method,
            trace=trace,
            skin=self._skin,
        )

    def _procedure_record(self, training: TrainingState) -> ProcedureRecord | None:
        done = training.procedure
        if done is None:
            return None
        plan = self._setup.scenario.procedure(done.name)
        sha256 = self._setup.procedure_sha256[done.name]
        return procedure_record(done, plan, sha256, self._feeds)


def _trace(training: TrainingState) -> tuple[TracePoint, ...]:
    points = () if training.trace is None else training.trace.points
    return tuple((*in_millimeters(point.position), point.sim_time) for point in points)


def _input_entry(times: dict[str, Any], operator_input: OperatorInput) -> dict[str, Any]:
    return {
        "kind": "input",
        **times,
        "translation": operator_input.translation,
        "rotation": operator_input.rotation,
        "fine": operator_input.fine,
        "operator": operator_input.operator,
    }


def _sample_entry(times: dict[str, Any], state: SimulationState) -> dict[str, Any]:
    is_fed = state.tool in (Tool.DRILL, Tool.ELECTRODE)
    return {
        "kind": "sample",
        **times,
        "q": state.q,
        "tipMm": [MM_PER_M * float(value) for value in state.tool_tip_to_world[:3, 3]],
        "clearanceMm": MM_PER_M * state.clearance,
        "depthMm": MM_PER_M * state.depth,
        **({"feedMm": MM_PER_M * state.feed} if is_fed else {}),
    }
