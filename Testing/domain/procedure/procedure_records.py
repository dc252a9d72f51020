"""Records of procedures for tests: what a robot did along the lines of a plan."""

import numpy as np

from rastrainer import transforms
from rastrainer.procedure.record import (
    PlacedInstrument,
    ProcedureRecord,
    RecordedAttempt,
    RegisteredTouch,
    TouchedCheckpoint,
    UsedRegistration,
)

STAND_OFF_MM = 30.0


def rotation(random, degrees):
    """A rotation about a random axis by up to an angle."""
    axis = random.normal(size=3)
    axis /= np.linalg.norm(axis)
    angle = np.radians(random.uniform(0.0, degrees))
    cross = np.cross(np.eye(3), axis)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def placed(trajectory, head_to_world, depth=None, drill=25.0, alignments=1):
    """An instrument placed along a planned line, in a head at a pose."""
    entry, target = (
        transforms.apply(head_to_world, point)
        for point in (trajectory.entry_ras, trajectory.target_ras)
    )
    direction = (target - entry) / np.linalg.norm(target - entry)
    tip = entry - STAND_OFF_MM * direction
    return PlacedInstrument(
        trajectory=trajectory.name,
        entry_ras=tuple(trajectory.entry_ras.tolist()),
        target_ras=tuple(trajectory.target_ras.tolist()),
        diameter_mm=trajectory.diameter_mm,
        guide_tip_mm=tuple(tip.tolist()),
        guide_direction=tuple(direction.tolist()),
        alignments=alignments,
        drill_depth_mm=STAND_OFF_MM + drill,
        instrument_depth_mm=STAND_OFF_MM + (trajectory.length_mm if depth is None else depth),
        times_s={"aligning": 20.0, "drilling": 10.0, "inserting": 15.0},
    )


def used(world_to_head):
    return UsedRegistration(tuple(world_to_head.ravel().tolist()), 0.8, 0.6)


def recorded(procedure, registered_head_to_world, **changes):
    """The record of a procedure carried out exactly by a registration.

    Args:
        procedure: the plan.
        registered_head_to_world: the inverse of the registration.
        changes: of each instrument, such as `depth`.
    """
    registration = used(transforms.inverse(registered_head_to_world))
    instruments = tuple(
        placed(each, registered_head_to_world, **changes) for each in procedure.trajectories
    )
    checks = (TouchedCheckpoint("Vertex", (1.0, 2.0, 3.0), 0.7, 60.0),)
    touches = (RegisteredTouch("1", (1.0, 2.0, 3.0)),)
    return ProcedureRecord(
        procedure=procedure.name,
        kind=procedure.kind,
        sha256="0" * 64,
        duration_s=200.0,
        attempts=(
            RecordedAttempt(touches, None, ()),
            RecordedAttempt((), registration, checks),
        ),
        instruments=instruments,
        phase_times_s={"running": 100.0, "verifying": 10.0},
    )
