"""The records of a trial that is over, its procedure included, made of its state and journal."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from rastrainer.journal.entries import (
    Continued,
    Entry,
    JournalHeader,
    Line,
    PhaseChange,
    Registered,
    Sample,
)
from rastrainer.json_records import record_to_json
from rastrainer.motion.trajectory import Trajectory
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.procedure.plan import Procedure, ProcedureTrajectory
from rastrainer.procedure.record import (
    PlacedInstrument,
    ProcedureRecord,
    RecordedAttempt,
    RegisteredTouch,
    TouchedCheckpoint,
)
from rastrainer.protocol import PROCEDURE_PHASES, Phase
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.how_played import PlayRecording, SeedSource
from rastrainer.trial.record import AbortedTrial, TouchedPoint, TrialRecord
from rastrainer_simulator.record.trial_context import display_summary, versions
from rastrainer_simulator.state import SimulationState, TrainingState
from rastrainer_simulator.trial_state import ProcedureState, RegistrationAttempt, TrajectoryState
from rastrainer_simulator.vectors import in_millimeters, vector

if TYPE_CHECKING:
    from rastrainer_simulator.core.simulation import Simulation


class TrialRecords:
    """Makes the records of a trial from its state, its journal, and the `dates` of its points."""

    def __init__(self, simulation: Simulation, header: JournalHeader, started_utc: str) -> None:
        self.header = header
        self.started_utc = started_utc
        self.versions = versions_of(simulation)
        self.reports: list[Entry] = []
        self.feeds = FeedRecording()
        self.play = PlayRecording()
        self._setup = simulation.setup
        # Its seed is revealed with the truth.
        self._skin = replace(simulation.truth.skin, seed=0)
        self.dates: dict[float, str] = {}

    def aborted(self, before: SimulationState, reason: str, utc: str) -> AbortedTrial:
        training = before.training
        stage = training.phase if training.procedure is None else training.procedure.stage
        return AbortedTrial(
            aborted_utc=utc,
            elapsed_s=before.elapsed,
            # A paused procedure is aborted in the phase before the pause.
            phase=(stage if stage in PROCEDURE_PHASES else training.phase).value,
            reason=reason,
            traced=0 if training.trace is None else len(training.trace.points),
            **self._in_both(training),
        )

    def registered(self, state: SimulationState) -> TrialRecord:
        """Return the record of a trial that has just been registered, without its motion."""
        training = state.training
        traced = () if training.trace is None else training.trace.points
        done, procedure = training.procedure, None
        if done is not None:
            plan = self._setup.scenario.procedure(done.name)
            sha256 = self._setup.procedure_sha256[done.name]
            procedure = procedure_record(done, plan, sha256, self.feeds)
        return TrialRecord(
            completed_utc=self.dates[(traced or training.touches)[-1].sim_time],
            completion_time_s=training.completed_s,
            display=display_summary(self.reports),
            procedure=procedure,
            trace=tuple((*in_millimeters(point.position), point.sim_time) for point in traced),
            skin=self._skin,
            played=self.play.played(),
            **self._in_both(training),
        )

    def _in_both(self, training: TrainingState) -> dict[str, Any]:
        return {
            **of_header(self.header),
            "started_utc": self.started_utc,
            "points": tuple(
                TouchedPoint(
                    label=touch.label,
                    position_mm=in_millimeters(touch.position),
                    sim_time_s=touch.sim_time,
                    utc=self.dates[touch.sim_time],
                )
                for touch in training.touches
            ),
            "rejected_touches": training.rejected,
            "undone_touches": training.undone,
            "versions": self.versions,
        }


def versions_of(simulation: Simulation) -> dict[str, str]:
    return versions() | {"kinematics": simulation.kinematics_name}


def of_header(header: JournalHeader) -> dict[str, Any]:
    """Return what the record of a trial repeats of its journal's header."""
    return {
        "trial_id": header.trial_id,
        "trainee": header.trainee,
        "task": header.task,
        "mode": header.mode,
        "scenario": header.scenario.name,
        "touch_rule": header.settings["training"]["touchRule"],
        "method": header.registration_method,
        "number": header.number,
        "series": header.series,
    }


@dataclass(frozen=True)
class UnmeasuredRecord:
    """Work that the tick of Register leaves to another thread.

    A long trial's motion metrics take longer than a tick. `seed` gives the head's pose.
    """

    record: TrialRecord
    seed: int
    trajectory: Trajectory

    def measured(self, was_played: Callable[[int], bool] = lambda _seed: False) -> TrialRecord:
        """Return the record with its motion metrics.

        `was_played` returns whether an earlier trial had a seed.
        """
        played = self.record.played
        if played is not None and played.seed_source != SeedSource.DRAWN.value:
            played = replace(played, is_seed_repeated=was_played(self.seed))
        return replace(self.record, motion=trial_motion(self.trajectory), played=played)


def with_record(lines: Iterable[Line], record: TrialRecord) -> list[Line]:
    whole = record_to_json(record)
    return [
        Line(at, replace(entry, record=whole) if isinstance(entry, Registered) else entry)
        for at, entry in lines
    ]


MEANINGFUL_MM = 0.05
"""Distance back after which a feed counts as reversed."""
_NAMES = {Phase.DRILLING: "drill", Phase.INSERTING: "instrument"}


@dataclass
class _Feeding:
    """What one instrument did along one trajectory, over all alignments."""

    path_mm: float = 0.0
    moving_s: float = 0.0
    fastest_mm_s: float = 0.0
    reversals: int = 0
    # Since the last reversal: the direction, and the farthest depth in it.
    way: float = 0.0
    farthest_mm: float = 0.0

    def move(self, depth_mm: float, step_mm: float, time_s: float) -> None:
        if step_mm == 0.0:
            return
        self.path_mm += abs(step_mm)
        self.moving_s += time_s
        self.fastest_mm_s = max(self.fastest_mm_s, abs(step_mm) / time_s)
        direction = 1.0 if step_mm > 0.0 else -1.0
        if self.way == 0.0:
            self.way, self.farthest_mm = direction, depth_mm
        elif self.way * (depth_mm - self.farthest_mm) >= 0.0:
            self.farthest_mm = depth_mm
        elif abs(depth_mm - self.farthest_mm) > MEANINGFUL_MM:
            self.reversals += 1
            self.way, self.farthest_mm = -self.way, depth_mm


class FeedRecording:
    """Collects the samples of drill and instrument; `metrics` describe a trajectory so far."""

    def __init__(self) -> None:
        self._trajectory = 0
        self._tool = ""
        self._last: tuple[float, float] | None = None
        self._feedings: dict[tuple[int, str], _Feeding] = defaultdict(_Feeding)

    def add(self, line: Line) -> None:
        entry = line.entry
        if isinstance(entry, Sample) and entry.feed_mm is not None:
            sim_time, depth_mm = line.at.sim_time_s, entry.feed_mm
            feeding = self._feedings[self._trajectory, self._tool]
            if self._last is None:
                # Another hole begins, or the same one after a pause: that is no reversal.
                feeding.way = 0.0
            else:
                time, depth = self._last
                feeding.move(depth_mm, depth_mm - depth, sim_time - time)
            self._last = sim_time, depth_mm
        elif isinstance(entry, PhaseChange) and entry.procedure is not None:
            self._trajectory = entry.procedure.trajectory
            self._tool = _NAMES.get(entry.procedure.stage, "")
            self._last = None
        elif isinstance(entry, Continued):
            self._last = None

    def metrics(self, trajectory: int) -> dict[str, float]:
        """Return the metrics of a trajectory, counted from 0: names with numbers of mm, s, mm/s."""
        found: dict[str, float] = {}
        for tool in _NAMES.values():
            feeding = self._feedings[trajectory, tool]
            found[f"{tool}_path_mm"] = feeding.path_mm
            found[f"{tool}_moving_s"] = feeding.moving_s
            found[f"{tool}_fastest_mm_s"] = feeding.fastest_mm_s
            found[f"{tool}_reversals"] = feeding.reversals
        return found


def procedure_record(
    state: ProcedureState, plan: Procedure, sha256: str, feeds: FeedRecording
) -> ProcedureRecord:
    """Return the record of a procedure whose last instrument was released; `sha256` of its plan."""
    assert state.ended_s is not None, "it is finished"
    pairs = enumerate(zip(state.trajectories, plan.trajectories, strict=True))
    return ProcedureRecord(
        procedure=plan.name,
        kind=plan.kind,
        sha256=sha256,
        duration_s=state.ended_s,
        attempts=tuple(map(_attempt, state.attempts)),
        instruments=tuple(
            _instrument(done, planned, feeds.metrics(number)) for number, (done, planned) in pairs
        ),
        phase_times_s=_times([state.times_s, *(each.times_s for each in state.trajectories)]),
    )


def _attempt(attempt: RegistrationAttempt) -> RecordedAttempt:
    return RecordedAttempt(
        touches=tuple(
            RegisteredTouch(t.label, in_millimeters(t.position)) for t in attempt.touches
        ),
        registration=attempt.registration,
        checkpoints=tuple(
            TouchedCheckpoint(
                point.name, in_millimeters(point.position), MM_PER_M * point.error, point.sim_time
            )
            for point in attempt.checkpoints
        ),
    )


def _instrument(
    done: TrajectoryState, planned: ProcedureTrajectory, feed: Mapping[str, float]
) -> PlacedInstrument:
    assert done.guide is not None, "it was locked"
    assert done.instrument_depth is not None, "it was released"
    return PlacedInstrument(
        trajectory=planned.name,
        entry_ras=vector(planned.entry_ras.tolist()),
        target_ras=vector(planned.target_ras.tolist()),
        diameter_mm=planned.diameter_mm,
        guide_tip_mm=in_millimeters(done.guide.tip),
        guide_direction=done.guide.direction,
        alignments=done.alignments,
        drill_depth_mm=MM_PER_M * done.drill_depth,
        instrument_depth_mm=MM_PER_M * done.instrument_depth,
        self_aligned=done.is_self_aligned,
        times_s=_times([done.times_s]),
        feed=feed,
    )


def _times(parts: Iterable[Mapping[Phase, float]]) -> dict[str, float]:
    total: dict[str, float] = {}
    for part in parts:
        for phase, seconds in part.items():
            total[phase.value] = total.get(phase.value, 0.0) + seconds
    return total
