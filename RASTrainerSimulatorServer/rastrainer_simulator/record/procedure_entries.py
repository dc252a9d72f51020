"""The record of a procedure that has just been finished."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rastrainer.journal.feed_recording import FeedRecording
from rastrainer.procedure.plan import Procedure, ProcedureTrajectory
from rastrainer.procedure.record import (
    PlacedInstrument,
    ProcedureRecord,
    RecordedAttempt,
    RegisteredTouch,
    TouchedCheckpoint,
    UsedRegistration,
)
from rastrainer.protocol import Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.procedure_state import ProcedureState, TrajectoryState
from rastrainer_simulator.registration_state import FinalRegistration, RegistrationAttempt
from rastrainer_simulator.vectors import Vector, vector


def procedure_record(
    state: ProcedureState, plan: Procedure, sha256: str, feeds: FeedRecording
) -> ProcedureRecord:
    """Return the record of a procedure whose last instrument was released.

    Args:
        state: of the procedure.
        plan: as the scenario has it.
        sha256: of its content.
        feeds: the samples of drill and instrument.
    """
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
        touches=tuple(RegisteredTouch(t.label, _mm(t.position)) for t in attempt.touches),
        registration=None if attempt.registration is None else _used(attempt.registration),
        checkpoints=tuple(
            TouchedCheckpoint(
                point.name, _mm(point.position), MM_PER_M * point.error, point.sim_time
            )
            for point in attempt.checkpoints
        ),
    )


def _used(registration: FinalRegistration) -> UsedRegistration:
    return UsedRegistration(registration.matrix, registration.fre_mm, registration.expected_tre_mm)


def _instrument(
    done: TrajectoryState, planned: ProcedureTrajectory, feed: Mapping[str, float]
) -> PlacedInstrument:
    assert done.guide is not None, "it was locked"
    assert done.instrument_depth is not None, "it was released"
    return PlacedInstrument(
        trajectory=planned.name,
        entry_ras=vector(planned.entry.tolist()),
        target_ras=vector(planned.target.tolist()),
        diameter_mm=planned.diameter_mm,
        guide_tip_mm=_mm(done.guide.tip),
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


def _mm(position: Vector) -> Vector:
    return vector(MM_PER_M * value for value in position)
