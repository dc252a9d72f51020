"""Measures of a planned procedure, and whether it can be carried out on its head.

The reach of the robot is not checked here; it needs the robot.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Annotated

import numpy as np

from rastrainer.head.mesh import HeadMesh, mesh_crossings, nearest_on_mesh
from rastrainer.json_checks import number, text
from rastrainer.procedure import geometry
from rastrainer.procedure.plan import Procedure, ProcedureMeshes, ProcedureTrajectory

OUTSIDE_MM = 60.0
"""Before the entry: outside of the head, also where the entry is planned on the bone."""

_DISTANCE = number(-1e4, 1e4, "mm")


@dataclass(frozen=True)
class LineMeasures:
    """The measures of one planned line.

    Attributes:
        skull_angle_deg: to the skull's normal where the line meets it; None if it does not.
        no_go_mm: from the surface of the instrument to each no-go structure, by name; below 0 it
            overlaps the structure.
        nearest_line_mm: between the surfaces of both instruments; None if there is no other.
        is_held: whether the robot can hold the guide on the line; None if that was not tried.
    """

    name: Annotated[str, text(60)]
    length_mm: Annotated[float, _DISTANCE]
    skull_angle_deg: Annotated[float | None, number(0, 180)]
    no_go_mm: Mapping[str, Annotated[float, _DISTANCE]]
    nearest_line: Annotated[str, text(60, 0)]
    nearest_line_mm: Annotated[float | None, _DISTANCE]
    is_held: bool | None = None

    @property
    def nearest_no_go(self) -> str:
        """Name of the nearest no-go structure; empty if there is none."""
        return min(self.no_go_mm, key=self.no_go_mm.__getitem__, default="")


@dataclass(frozen=True)
class MeasuredProcedure:
    """A procedure as it would be on a head; `wrong` has a sentence for each error."""

    procedure: Annotated[str, text(40)]
    title: Annotated[str, text(80)]
    lines: tuple[LineMeasures, ...]
    wrong: tuple[Annotated[str, text(2000)], ...]


def planned_bone(trajectory: ProcedureTrajectory, skull: HeadMesh) -> geometry.BoneAhead | None:
    """Return where the planned line goes through bone, as distances from the entry in mm.

    They are below 0 if the entry is planned below the bone's surface.
    """
    direction = trajectory.direction
    start = trajectory.entry_ras - OUTSIDE_MM * direction
    bone = geometry.bone_ahead(skull, start, direction, OUTSIDE_MM + trajectory.length_mm)
    if bone is None:
        return None
    inner = None if bone.inner_mm is None else bone.inner_mm - OUTSIDE_MM
    return geometry.BoneAhead(bone.outer_mm - OUTSIDE_MM, inner)


def distances_to_no_go(
    trajectory: ProcedureTrajectory, meshes: ProcedureMeshes
) -> dict[str, float]:
    """Return how far the instrument's surface stays from each no-go structure, mm, by name."""
    radius = trajectory.diameter_mm / 2
    return {
        name: geometry.axis_distance_mm(mesh, trajectory.entry_ras, trajectory.target_ras) - radius
        for name, mesh in meshes.no_go.items()
    }


def line_distance_mm(one: ProcedureTrajectory, other: ProcedureTrajectory) -> float:
    """Return the distance between the surfaces of two instruments, mm; below 0 they overlap."""
    axes = geometry.segment_distances_mm(
        one.entry_ras, one.target_ras, np.array([other.entry_ras]), np.array([other.target_ras])
    )
    return float(axes[0]) - (one.diameter_mm + other.diameter_mm) / 2


def measure_lines(procedure: Procedure, meshes: ProcedureMeshes) -> list[LineMeasures]:
    measured = []
    for trajectory in procedure.trajectories:
        others = {
            other.name: line_distance_mm(trajectory, other)
            for other in procedure.trajectories
            if other is not trajectory
        }
        nearest = min(others, key=others.__getitem__, default="")
        bone, direction, angle = planned_bone(trajectory, meshes.skull), trajectory.direction, None
        if bone is not None:
            point = trajectory.entry_ras + bone.outer_mm * direction
            angle = geometry.skull_angle_deg(meshes.skull, point, direction)
        measured.append(
            LineMeasures(
                name=trajectory.name,
                length_mm=trajectory.length_mm,
                skull_angle_deg=angle,
                no_go_mm=distances_to_no_go(trajectory, meshes),
                nearest_line=nearest,
                nearest_line_mm=others.get(nearest),
            )
        )
    return measured


ENTRY_OFF_SKIN_MM = 10.0
"""Many plan the entry on the bone, below some 7 mm of scalp, or click a little off the skin."""
CHECKPOINT_OFF_SKIN_MM = 1.0
MAX_LENGTH_MM = 150.0
"""Longest line from entry to target; drill and instrument reach 250 mm beyond the guide."""
MAX_SKULL_ANGLE_DEG = 40.0
"""Largest angle to the skull's normal; a drill that meets bone at a flatter angle slips. Our own
convention."""
APART_MM = 1.0
"""Least distance between the surfaces of two instruments. Our own convention."""


def check_procedure(
    procedure: Procedure, head: HeadMesh, meshes: ProcedureMeshes
) -> tuple[list[LineMeasures], list[str]]:
    """Return the measures of a plan's lines, and a sentence for each error of the plan.

    `head` is the closed skin, RAS mm.
    """
    lines, wrong = measure_lines(procedure, meshes), unusable_lines(procedure, head, meshes.skull)
    if wrong:
        return lines, wrong
    for line, trajectory in zip(lines, procedure.trajectories, strict=True):
        about = f"{procedure.title}: {line.name}"
        wrong += [f"{about} {what}" for what in _questionable(line, trajectory.safety_mm)]
    for one, other in combinations(procedure.trajectories, 2):
        distance = line_distance_mm(one, other)
        if distance < APART_MM:
            wrong.append(
                f"{procedure.title}: {one.name} and {other.name} come within "
                f"{max(distance, 0.0):.1f} mm of each other; they must stay {APART_MM:g} mm apart."
            )
    for checkpoint in procedure.checkpoints:
        away = nearest_on_mesh(head, checkpoint.position_ras).distance
        if away > CHECKPOINT_OFF_SKIN_MM:
            wrong.append(
                f"{procedure.title}: the checkpoint {checkpoint.name} is {away:.1f} mm off the "
                f"skin; it must be within {CHECKPOINT_OFF_SKIN_MM:g} mm."
            )
    return lines, wrong


def unusable_lines(procedure: Procedure, head: HeadMesh, skull: HeadMesh) -> list[str]:
    """Return a sentence for each trajectory along which nothing can be drilled and placed.

    Skin (`head`) and skull are closed surfaces, RAS mm.
    """
    return [
        f"{procedure.title}: {trajectory.name} {what}"
        for trajectory in procedure.trajectories
        if (what := _unusable(trajectory, head, skull))
    ]


def entry_fault(off_skin_mm: float) -> str | None:
    """Return the fault of an entry at this height above the skin, or None; negative is inside."""
    if abs(off_skin_mm) <= ENTRY_OFF_SKIN_MM:
        return None
    side = "above the skin" if off_skin_mm > 0.0 else "below the skin, within the head"
    entry = f"its entry must be within {ENTRY_OFF_SKIN_MM:g} mm of the skin."
    return f"enters {abs(off_skin_mm):.0f} mm {side}; {entry}"


def _unusable(trajectory: ProcedureTrajectory, head: HeadMesh, skull: HeadMesh) -> str | None:
    entry, target, direction = trajectory.entry_ras, trajectory.target_ras, trajectory.direction
    if not geometry.is_inside(head, target):
        outside = nearest_on_mesh(head, target).distance
        return f"has its target {outside:.0f} mm outside of the head."
    off_skin = nearest_on_mesh(head, entry).distance
    if off_skin > ENTRY_OFF_SKIN_MM and geometry.is_inside(head, entry):
        off_skin = -off_skin
    if fault := entry_fault(off_skin):
        return fault
    crossings = mesh_crossings(head, entry, direction, trajectory.length_mm)
    leaving = [crossing for crossing in crossings if not crossing.is_entering]
    if leaving:
        before = trajectory.length_mm - leaving[0].distance_mm
        return f"leaves the head {before:.0f} mm before its target; it must stay within it."
    bone = planned_bone(trajectory, skull)
    if bone is None:
        return "does not go through the skull; drilling needs bone."
    if bone.inner_mm is None:
        return (
            "meets a skull without an inner table; make the skull again, or from a CT, so that it "
            "has one."
        )
    return None


def _questionable(line: LineMeasures, safety_mm: float) -> Iterator[str]:
    if line.length_mm > MAX_LENGTH_MM:
        yield f"is {line.length_mm:.0f} mm long; it may be {MAX_LENGTH_MM:g} mm."
    angle = line.skull_angle_deg
    assert angle is not None, "it is usable"
    if angle > MAX_SKULL_ANGLE_DEG:
        yield (
            f"meets the skull at {angle:.0f}° to its normal; it may be {MAX_SKULL_ANGLE_DEG:g}°."
        )
    for name, distance in line.no_go_mm.items():
        if distance <= 0.0:
            yield f"goes through {name}."
        elif distance < safety_mm:
            yield (
                f"comes within {distance:.1f} mm of {name}; its safety distance is "
                f"{safety_mm:g} mm."
            )
