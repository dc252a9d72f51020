"""The records of a trial that is registered or aborted, made of its state and what was noted."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from rastrainer.motion.trajectory import Trajectory
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.procedure.record import ProcedureRecord
from rastrainer.protocol import PROCEDURE_PHASES
from rastrainer.trial.aborted_trial import AbortedTrial
from rastrainer.trial.record import TouchedPoint, TracePoint, TrialRecord
from rastrainer_simulator.record.beside_the_trial import DisplayUse
from rastrainer_simulator.record.procedure_entries import FeedRecording, procedure_record
from rastrainer_simulator.record.recorded_setup import versions
from rastrainer_simulator.state import SimulationState, TrainingState
from rastrainer_simulator.vectors import in_millimeters

if TYPE_CHECKING:
    from rastrainer_simulator.core.simulation import Simulation


class TrialRecords:
    """What a trial's record holds beside its state, and the records made of both.

    Attributes:
        started_utc: when it was started, ISO 8601.
        versions: of what it is played with.
        display: how its views drew.
        feeds: of drill and instrument.
    """

    def __init__(self, simulation: Simulation, started_utc: str) -> None:
        self.started_utc = started_utc
        self.versions = versions() | {"kinematics": simulation.kinematics_name}
        self.display = DisplayUse()
        self.feeds = FeedRecording()
        self._setup = simulation.setup
        # Its seed is revealed with the truth.
        self._skin = replace(simulation.truth.skin, seed=0)
        self._utc: dict[float, str] = {}

    def date(self, sim_time: float, utc: str) -> None:
        """Take note when a point was touched or traced."""
        self._utc[sim_time] = utc

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

    def registered(self, state: SimulationState) -> TrialRecord:
        """Return the record of a trial that has just been registered, without its motion."""
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
            display=self.display.summary(),
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
        return procedure_record(done, plan, sha256, self.feeds)


def _trace(training: TrainingState) -> tuple[TracePoint, ...]:
    points = () if training.trace is None else training.trace.points
    return tuple((*in_millimeters(point.position), point.sim_time) for point in points)


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
