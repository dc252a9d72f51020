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
instrument; the target point error that of the planned target from the instrument's tip, which has
a part along the planned line (depth error, positive where the tip is too deep) and one across it
(radial error); the angular deviation is the angle between the planned and the actual direction.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.procedure.geometry import BoneAhead, angle_deg, axis_distance_mm, bone_ahead
from rastrainer.procedure.plan import Procedure, ProcedureMeshes, ProcedureTrajectory
from rastrainer.procedure.record import DEPTH_LIMIT_MM, PlacedInstrument, ProcedureRecord

SAME_MM = 1e-3
"""Plans are written with four decimals."""
PLANNED_COLOR = (0x8F / 255, 0xF0 / 255, 0xD0 / 255)
REGISTERED_COLOR = (1.0, 0xE0 / 255, 0.0)
PLACED_COLOR = (0x3F / 255, 0x8F / 255, 0xE0 / 255)
"""Colors (sRGB) of the planned lines, of those that the registration showed and of what was placed,
and of the errors by registration and hand: the same in every picture. People who are blind to red
or green can distinguish green, yellow and blue, too."""


@dataclass(frozen=True, eq=False)
class SplitError:
    """An error vector from the planned to the reached point, RAS mm.

    Attributes:
        by_registration: (3,) float, from the planned point to where the registration put it.
        by_hand: (3,) float, from there to the point that was reached.
    """

    by_registration: np.ndarray
    by_hand: np.ndarray

    @property
    def whole(self) -> np.ndarray:
        """(3,) float, the sum of both."""
        return self.by_registration + self.by_hand

    @property
    def length_mm(self) -> float:
        return float(np.linalg.norm(self.whole))

    @property
    def registration_mm(self) -> float:
        """Length of what the registration caused."""
        return float(np.linalg.norm(self.by_registration))

    @property
    def hand_mm(self) -> float:
        """Length of what the hand caused."""
        return float(np.linalg.norm(self.by_hand))

    def along(self, direction: np.ndarray) -> tuple[float, float, float]:
        """Return the whole error and both parts along a unit vector (3,), mm, signed."""
        parts = (self.whole, self.by_registration, self.by_hand)
        whole, registration, hand = (float(part @ direction) for part in parts)
        return whole, registration, hand

    def across(self, direction: np.ndarray) -> SplitError:
        """Return the error without its part along a unit vector (3,)."""
        return SplitError(
            *(
                part - (part @ direction) * direction
                for part in (self.by_registration, self.by_hand)
            )
        )

    def to_json(self) -> dict[str, Any]:
        """Return lengths and vectors, ready for JSON."""
        return {
            "mm": self.length_mm,
            "byRegistrationMm": self.registration_mm,
            "byHandMm": self.hand_mm,
            "byRegistrationRas": self.by_registration.tolist(),
            "byHandRas": self.by_hand.tolist(),
        }


@dataclass(frozen=True, eq=False)
class TrajectoryErrors:
    """The errors of one instrument against the truth.

    Attributes:
        trajectory: as planned.
        instrument: as recorded.
        entry: entry point error, across the axis of the instrument.
        target: target point error.
        shown_direction: (3,) float, RAS: the true direction of the line that was shown.
        axis_start: (3,) float, RAS: where the guide's tip truly was.
        axis_direction: (3,) float, RAS, unit vector: the true direction of the instrument.
        bone: where the axis truly goes through the skull, from the guide's tip; None if it
            misses it.
        kept_mm: distances from the surface of the instrument (or of the drill, where it went
            deeper; taken as thick) to each no-go structure, by name; 0 or less is a hit.
    """

    trajectory: ProcedureTrajectory
    instrument: PlacedInstrument
    entry: SplitError
    target: SplitError
    shown_direction: np.ndarray
    axis_start: np.ndarray
    axis_direction: np.ndarray
    bone: BoneAhead | None
    kept_mm: Mapping[str, float]

    @property
    def tip(self) -> np.ndarray:
        """(3,) float, RAS: where the tip of the instrument truly is."""
        return self.axis_start + self.instrument.instrument_depth_mm * self.axis_direction

    @property
    def shown_entry(self) -> np.ndarray:
        """(3,) float, RAS: where the planned entry, as it was shown, truly lay in the head."""
        return self.shown_target - self.trajectory.length_mm * self.shown_direction

    @property
    def shown_target(self) -> np.ndarray:
        """(3,) float, RAS: the same of the planned target."""
        return self.trajectory.target_ras + self.target.by_registration

    @property
    def depth(self) -> tuple[float, float, float]:
        """Depth error and what registration and hand caused of it, mm; above 0 is too deep."""
        return self.target.along(self.trajectory.direction)

    @property
    def radial(self) -> SplitError:
        return self.target.across(self.trajectory.direction)

    @property
    def angle_deg(self) -> float:
        """Angular deviation."""
        return angle_deg(self.trajectory.direction, self.axis_direction)

    @property
    def registration_angle_deg(self) -> float:
        """The angle by which the registration turned the shown line.

        The whole deviation is at most the sum of this and `hand_angle_deg`: angles are no vectors.
        """
        return angle_deg(self.trajectory.direction, self.shown_direction)

    @property
    def hand_angle_deg(self) -> float:
        """The angle between the shown line and the instrument."""
        return angle_deg(self.shown_direction, self.axis_direction)

    @property
    def plunge_mm(self) -> float | None:
        """How deep the drill was past the inner table; None if the axis misses it."""
        if self.bone is None or self.bone.inner_mm is None:
            return None
        return max(0.0, self.instrument.drill_depth_mm - self.bone.inner_mm)

    @property
    def hits(self) -> tuple[str, ...]:
        """Names of the no-go structures that were hit."""
        return tuple(name for name, distance in self.kept_mm.items() if distance <= 0.0)

    @property
    def intrusion_mm(self) -> float:
        """How far the instrument is within its safety distance to a no-go structure; 0 if not."""
        least = min(self.kept_mm.values(), default=np.inf)
        return float(max(0.0, self.trajectory.safety_mm - least))

    def to_json(self) -> dict[str, Any]:
        """Return the errors, ready for JSON."""
        depth, depth_by_registration, depth_by_hand = self.depth
        bone = self.bone
        return {
            "trajectory": self.trajectory.name,
            "entryPointError": self.entry.to_json(),
            "targetPointError": self.target.to_json(),
            "radialError": self.radial.to_json(),
            "depthErrorMm": depth,
            "depthErrorByRegistrationMm": depth_by_registration,
            "depthErrorByHandMm": depth_by_hand,
            "angularDeviationDeg": self.angle_deg,
            "angularDeviationByRegistrationDeg": self.registration_angle_deg,
            "angularDeviationByHandDeg": self.hand_angle_deg,
            "outerTableMm": None if bone is None else bone.outer_mm,
            "innerTableMm": None if bone is None else bone.inner_mm,
            "plungeMm": self.plunge_mm,
            "keptMm": dict(self.kept_mm),
            "guideTipRas": self.axis_start.tolist(),
            "tipRas": self.tip.tolist(),
            "alignments": self.instrument.alignments,
            "selfAligned": self.instrument.self_aligned,
            "timesS": dict(self.instrument.times_s),
        }


@dataclass(frozen=True, eq=False)
class ProcedureAnalysis:
    """The errors of a whole procedure.

    Attributes:
        record: what was done.
        trajectories: their errors, in the order of the plan.
    """

    record: ProcedureRecord
    trajectories: tuple[TrajectoryErrors, ...]

    @cached_property
    def target_rms_mm(self) -> float:
        """Root mean square of the target point errors."""
        return _rms([each.target.length_mm for each in self.trajectories])

    @cached_property
    def entry_rms_mm(self) -> float:
        """Root mean square of the entry point errors."""
        return _rms([each.entry.length_mm for each in self.trajectories])

    @cached_property
    def angle_rms_deg(self) -> float:
        """Root mean square of the angular deviations."""
        return _rms([each.angle_deg for each in self.trajectories])

    @property
    def target_by_registration_rms_mm(self) -> float:
        """Root mean square of what the registration caused of the target point errors."""
        return _rms([each.target.registration_mm for each in self.trajectories])

    @property
    def target_by_hand_rms_mm(self) -> float:
        """Root mean square of what the hand caused of the target point errors."""
        return _rms([each.target.hand_mm for each in self.trajectories])

    @property
    def hits(self) -> tuple[tuple[str, str], ...]:
        return tuple(
            (each.trajectory.name, name) for each in self.trajectories for name in each.hits
        )

    @property
    def missed_bone(self) -> tuple[str, ...]:
        """Names of trajectories whose axis does not go through the skull."""
        return tuple(each.trajectory.name for each in self.trajectories if each.plunge_mm is None)

    def to_json(self) -> dict[str, Any]:
        """Return the errors, ready for JSON."""
        return {
            "procedure": self.record.procedure,
            "kind": self.record.kind.value,
            "targetPointErrorRmsMm": self.target_rms_mm,
            "targetPointErrorByRegistrationRmsMm": self.target_by_registration_rms_mm,
            "targetPointErrorByHandRmsMm": self.target_by_hand_rms_mm,
            "entryPointErrorRmsMm": self.entry_rms_mm,
            "angularDeviationRmsDeg": self.angle_rms_deg,
            "alignments": self.record.alignments,
            "attempts": len(self.record.attempts),
            "durationS": self.record.duration_s,
            "phaseTimesS": dict(self.record.phase_times_s),
            "trajectories": [each.to_json() for each in self.trajectories],
        }


def analyze_procedure(
    record: ProcedureRecord,
    procedure: Procedure,
    meshes: ProcedureMeshes,
    head_to_world: np.ndarray,
) -> ProcedureAnalysis:
    """Return the errors of a procedure against the truth.

    Args:
        record: what was done, with the registration that was accepted.
        procedure: what was planned.
        meshes: of the procedure, RAS mm.
        head_to_world: (4, 4) float, rigid, mm: where the head really was.
    """
    _check_same(record, procedure)
    world_to_ras = transforms.inverse(head_to_world)
    shown = world_to_ras @ transforms.inverse(record.accepted.world_to_head)
    pairs = zip(procedure.trajectories, record.instruments, strict=True)
    return ProcedureAnalysis(
        record,
        tuple(_errors(plan, done, meshes, shown, world_to_ras) for plan, done in pairs),
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
    shown_entry, shown_target = (
        transforms.apply(shown, point) for point in (plan.entry_ras, plan.target_ras)
    )
    deepest = start + max(done.instrument_depth_mm, done.drill_depth_mm) * direction
    radius = done.diameter_mm / 2
    return TrajectoryErrors(
        trajectory=plan,
        instrument=done,
        entry=SplitError(shown_entry - plan.entry_ras, start - shown_entry).across(direction),
        target=SplitError(shown_target - plan.target_ras, tip - shown_target),
        shown_direction=shown[:3, :3] @ plan.direction,
        axis_start=start,
        axis_direction=direction,
        bone=bone_ahead(meshes.skull, start, direction, DEPTH_LIMIT_MM),
        kept_mm={
            name: axis_distance_mm(mesh, start, deepest) - radius
            for name, mesh in meshes.no_go.items()
        },
    )


def _check_same(record: ProcedureRecord, procedure: Procedure) -> None:
    planned = [(each.name, each.entry_ras, each.target_ras) for each in procedure.trajectories]
    done = [(each.trajectory, each.entry_ras, each.target_ras) for each in record.instruments]
    is_same = len(planned) == len(done) and all(
        one[0] == other[0] and np.allclose(one[1:], other[1:], rtol=0.0, atol=SAME_MM)
        for one, other in zip(planned, done, strict=True)
    )
    if not is_same or record.procedure != procedure.name:
        raise InputError(
            f"The record is of another plan than the procedure {procedure.name!r} of this scenario."
        )


def _rms(values: list[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
