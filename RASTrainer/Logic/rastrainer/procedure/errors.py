"""The errors of a procedure against the truth, and how much the registration and the hand caused.

The trainee sees the plan where their registration puts it, so its error goes into the patient.
With T the true HeadToWorld and R the WorldToHead of the registration, a planned point p (RAS) is
shown in World at R⁻¹p, which truly is T⁻¹R⁻¹p in the head. If a point a was reached in World, the
error in the head is

    T⁻¹a − p = (T⁻¹R⁻¹p − p) + (T⁻¹a − T⁻¹R⁻¹p)

from the planned point to the reached one: what the registration caused and what the hand caused,
exactly. All vectors here are in the head's frame, RAS mm. Where the robot brought the guide onto
the line (`PlacedInstrument.self_aligned`), the second part is the robot's, but for the depth.

Terms, as in reviews of the accuracy of stereotactic placement (Vakharia et al. 2017,
10.1111/epi.13713): the entry point error is the distance of the planned entry from the axis of the
instrument; the target point error is the distance of the planned target from the instrument's tip,
which has a part along the planned line (depth error, positive where the tip is too deep) and one
across it (radial error); the angular deviation is the angle between the planned and the actual
direction.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.json_checks import number, numbers, text, whole_number
from rastrainer.procedure.geometry import angle_deg, axis_distance_mm, bone_ahead
from rastrainer.procedure.plan import (
    Procedure,
    ProcedureKind,
    ProcedureMeshes,
    ProcedureTrajectory,
)
from rastrainer.procedure.record import (
    DEPTH_LIMIT_MM,
    PhaseTimes,
    PlacedInstrument,
    ProcedureRecord,
    Seconds,
)

SAME_MM = 1e-3
"""Plans are written with four decimals."""
PLANNED_COLOR = (0x8F / 255, 0xF0 / 255, 0xD0 / 255)
REGISTERED_COLOR = (1.0, 0xE0 / 255, 0.0)
PLACED_COLOR = (0x3F / 255, 0x8F / 255, 0xE0 / 255)
"""Colors (sRGB) of the planned lines, the lines shown by the registration and the placed
instruments, and of the errors by registration and hand: the same in every picture. People who are
blind to red or green can distinguish green, yellow and blue, too."""


_LIMIT = 1e6
_Length = Annotated[float, number(0, _LIMIT, "mm")]
_Signed = Annotated[float, number(-_LIMIT, _LIMIT, "mm")]
_Angle = Annotated[float, number(0, 180, "degrees")]
_Vector = Annotated[tuple[float, float, float], numbers(3, _LIMIT, "mm")]
_Count = Annotated[int, whole_number(0, 1_000_000)]


@dataclass(frozen=True)
class SplitError:
    """An error from the planned point to where the registration put it, and by hand from there to
    the reached point: lengths, and vectors in RAS."""

    mm: _Length
    by_registration_mm: _Length
    by_hand_mm: _Length
    by_registration_ras: _Vector
    by_hand_ras: _Vector

    @classmethod
    def of(cls, by_registration: np.ndarray, by_hand: np.ndarray) -> SplitError:
        """Return the error of two parts, (3,) float each, RAS mm."""
        parts = by_registration + by_hand, by_registration, by_hand
        whole, registration, hand = (float(np.linalg.norm(part)) for part in parts)
        vectors = tuple(by_registration.tolist()), tuple(by_hand.tolist())
        return cls(whole, registration, hand, *vectors)


@dataclass(frozen=True)
class TrajectoryErrors:
    """The errors of one instrument against the truth.

    Depths are above 0 if the tip is too deep. An angle is at most the sum of its parts: angles
    are no vectors.

    Attributes:
        entry_point_error: across the axis of the instrument.
        radial_error: the target point error, across the planned line.
        angular_deviation_by_registration_deg: by how much the registration turned the shown line.
        angular_deviation_by_hand_deg: between the shown line and the instrument.
        outer_table_mm: where the axis truly goes through the skull, from the guide's tip; None if
            it misses it. The same holds for the inner table.
        plunge_mm: how deep the drill was past the inner table; None if the axis misses it.
        kept_mm: distances from the surface of the instrument (or of the drill, where it went
            deeper; taken as thick) to each no-go structure, by name; 0 or less is a hit.
        self_aligned: whether the robot brought the guide onto the line.
    """

    trajectory: Annotated[str, text(60)]
    entry_point_error: SplitError
    target_point_error: SplitError
    radial_error: SplitError
    depth_error_mm: _Signed
    depth_error_by_registration_mm: _Signed
    depth_error_by_hand_mm: _Signed
    angular_deviation_deg: _Angle
    angular_deviation_by_registration_deg: _Angle
    angular_deviation_by_hand_deg: _Angle
    outer_table_mm: _Signed | None
    inner_table_mm: _Signed | None
    plunge_mm: _Length | None
    kept_mm: Mapping[str, _Signed]
    guide_tip_ras: _Vector
    tip_ras: _Vector
    alignments: _Count
    self_aligned: bool
    times_s: PhaseTimes


@dataclass(frozen=True)
class ProcedureAnalysis:
    """The errors of a whole procedure; those in RMS, and alignments, are over its trajectories."""

    procedure: Annotated[str, text(40)]
    kind: ProcedureKind
    target_point_error_rms_mm: _Length
    target_point_error_by_registration_rms_mm: _Length
    target_point_error_by_hand_rms_mm: _Length
    entry_point_error_rms_mm: _Length
    angular_deviation_rms_deg: _Angle
    alignments: _Count
    attempts: _Count
    duration_s: Seconds
    phase_times_s: PhaseTimes
    trajectories: tuple[TrajectoryErrors, ...]

    @property
    def self_aligned(self) -> int:
        """On how many trajectories the robot aligned the guide."""
        return sum(each.self_aligned for each in self.trajectories)

    @property
    def hits(self) -> tuple[tuple[str, str], ...]:
        """Trajectories and the no-go structures that they hit."""
        return tuple(
            (each.trajectory, name)
            for each in self.trajectories
            for name, distance in each.kept_mm.items()
            if distance <= 0.0
        )

    @property
    def missed_bone(self) -> tuple[str, ...]:
        """Names of trajectories whose axis does not go through the skull."""
        return tuple(each.trajectory for each in self.trajectories if each.plunge_mm is None)


def analyze_procedure(
    record: ProcedureRecord,
    procedure: Procedure,
    meshes: ProcedureMeshes,
    head_to_world: np.ndarray,
) -> ProcedureAnalysis:
    """Return the errors of a procedure; `head_to_world` (4, 4), mm, is the truth."""
    planned = [(each.name, each.entry_ras, each.target_ras) for each in procedure.trajectories]
    placed = [(each.trajectory, each.entry_ras, each.target_ras) for each in record.instruments]
    is_same = len(planned) == len(placed) and all(
        one[0] == other[0] and np.allclose(one[1:], other[1:], rtol=0.0, atol=SAME_MM)
        for one, other in zip(planned, placed, strict=True)
    )
    if not is_same or record.procedure != procedure.name:
        raise InputError(
            f"The record is of another plan than the procedure {procedure.name!r} of this scenario."
        )
    world_to_ras = transforms.inverse(head_to_world)
    shown = world_to_ras @ transforms.inverse(record.accepted.world_to_head)
    errors = tuple(
        _errors(plan, done, meshes, shown, world_to_ras)
        for plan, done in zip(procedure.trajectories, record.instruments, strict=True)
    )
    targets = [each.target_point_error for each in errors]
    return ProcedureAnalysis(
        procedure=record.procedure,
        kind=record.kind,
        target_point_error_rms_mm=_rms([each.mm for each in targets]),
        target_point_error_by_registration_rms_mm=_rms([e.by_registration_mm for e in targets]),
        target_point_error_by_hand_rms_mm=_rms([each.by_hand_mm for each in targets]),
        entry_point_error_rms_mm=_rms([each.entry_point_error.mm for each in errors]),
        angular_deviation_rms_deg=_rms([each.angular_deviation_deg for each in errors]),
        alignments=sum(each.alignments for each in record.instruments),
        attempts=len(record.attempts),
        duration_s=record.duration_s,
        phase_times_s=record.phase_times_s,
        trajectories=errors,
    )


def _errors(
    plan: ProcedureTrajectory,
    done: PlacedInstrument,
    meshes: ProcedureMeshes,
    shown: np.ndarray,
    world_to_ras: np.ndarray,
) -> TrajectoryErrors:
    """Return the errors of one instrument; `shown` maps planned points to where they were shown."""
    start = transforms.apply(world_to_ras, np.array(done.guide_tip_mm))
    direction = world_to_ras[:3, :3] @ np.array(done.guide_direction)
    direction /= np.linalg.norm(direction)
    tip = start + done.instrument_depth_mm * direction
    shown_direction = shown[:3, :3] @ plan.direction
    shown_entry, shown_target = (
        transforms.apply(shown, point) for point in (plan.entry_ras, plan.target_ras)
    )
    entry = shown_entry - plan.entry_ras, start - shown_entry
    target = shown_target - plan.target_ras, tip - shown_target
    depths = [float(part @ plan.direction) for part in (target[0] + target[1], *target)]
    deepest = start + max(done.instrument_depth_mm, done.drill_depth_mm) * direction
    bone = bone_ahead(meshes.skull, start, direction, DEPTH_LIMIT_MM)
    inner = None if bone is None else bone.inner_mm
    return TrajectoryErrors(
        trajectory=plan.name,
        entry_point_error=SplitError.of(*(_across(part, direction) for part in entry)),
        target_point_error=SplitError.of(*target),
        radial_error=SplitError.of(*(_across(part, plan.direction) for part in target)),
        depth_error_mm=depths[0],
        depth_error_by_registration_mm=depths[1],
        depth_error_by_hand_mm=depths[2],
        angular_deviation_deg=angle_deg(plan.direction, direction),
        angular_deviation_by_registration_deg=angle_deg(plan.direction, shown_direction),
        angular_deviation_by_hand_deg=angle_deg(shown_direction, direction),
        outer_table_mm=None if bone is None else bone.outer_mm,
        inner_table_mm=inner,
        plunge_mm=None if inner is None else max(0.0, done.drill_depth_mm - inner),
        kept_mm={
            name: axis_distance_mm(mesh, start, deepest) - done.diameter_mm / 2
            for name, mesh in meshes.no_go.items()
        },
        guide_tip_ras=tuple(start.tolist()),
        tip_ras=tuple(tip.tolist()),
        alignments=done.alignments,
        self_aligned=done.self_aligned,
        times_s=done.times_s,
    )


def _across(part: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Return a vector (3,) without its part along a unit vector."""
    return part - (part @ direction) * direction


class TrueLine(NamedTuple):
    """The line of one instrument in the head, from outside to inside: (2, 3) float each, RAS mm.

    `shown` is the true place of the plan as it was shown; `placed` begins at the guide's tip.
    """

    trajectory: str
    planned: np.ndarray
    shown: np.ndarray
    placed: np.ndarray


def true_lines(record: ProcedureRecord, head_to_world: np.ndarray) -> list[TrueLine]:
    """Return the lines of a procedure, of which `head_to_world` (4, 4) is the truth, mm."""
    to_ras = transforms.inverse(head_to_world)
    shown = to_ras @ transforms.inverse(record.accepted.world_to_head)
    lines = []
    for one in record.instruments:
        planned = np.array([one.entry_ras, one.target_ras])
        placed = np.array([one.guide_tip_mm, one.at_depth(one.instrument_depth_mm)])
        lines.append(
            TrueLine(
                one.trajectory,
                planned,
                transforms.apply(shown, planned),
                transforms.apply(to_ras, placed),
            )
        )
    return lines


def _rms(values: list[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
