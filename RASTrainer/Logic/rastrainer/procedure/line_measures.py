"""What is measured of planned lines before anything is drilled: lengths, angles and distances."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer.head.mesh import HeadMesh
from rastrainer.procedure.geometry import (
    BoneAhead,
    axis_distance_mm,
    bone_ahead,
    segment_distances_mm,
    skull_angle_deg,
)
from rastrainer.procedure.meshes import ProcedureMeshes
from rastrainer.procedure.plan import Procedure, ProcedureTrajectory

OUTSIDE_MM = 60.0
"""Before the entry: outside of the head, also where the entry is planned on the bone."""


@dataclass(frozen=True)
class LineMeasures:
    """What is measured of one planned line.

    Attributes:
        name: of the trajectory.
        length_mm: from entry to target.
        skull_angle_deg: to the skull's normal where the line meets it; None where it does not.
        no_go_mm: from the surface of the instrument to each no-go structure, by name; below 0 it
            overlaps the structure.
        nearest_line: name of the nearest other trajectory; empty where there is no other.
        nearest_line_mm: between the surfaces of both instruments; None where there is no other.
    """

    name: str
    length_mm: float
    skull_angle_deg: float | None
    no_go_mm: Mapping[str, float]
    nearest_line: str
    nearest_line_mm: float | None

    @property
    def nearest_no_go(self) -> str:
        """Name of the nearest no-go structure; empty where there is none."""
        return min(self.no_go_mm, key=self.no_go_mm.__getitem__, default="")

    def to_json(self) -> dict[str, Any]:
        """Return the measures, ready for JSON."""
        return {
            "name": self.name,
            "lengthMm": self.length_mm,
            "skullAngleDeg": self.skull_angle_deg,
            "noGoMm": dict(self.no_go_mm),
            "nearestLine": self.nearest_line,
            "nearestLineMm": self.nearest_line_mm,
        }


def measure_lines(procedure: Procedure, meshes: ProcedureMeshes) -> list[LineMeasures]:
    """Return the measures of each trajectory, in the order of the plan."""
    return [_measured(trajectory, procedure, meshes) for trajectory in procedure.trajectories]


def planned_bone(trajectory: ProcedureTrajectory, skull: HeadMesh) -> BoneAhead | None:
    """Return where the planned line goes through bone, as distances from the entry in mm.

    They are below 0 where the entry is planned below the bone's surface. None where the line does
    not go through bone.
    """
    direction = trajectory.direction
    start = trajectory.entry - OUTSIDE_MM * direction
    bone = bone_ahead(skull, start, direction, OUTSIDE_MM + trajectory.length_mm)
    if bone is None:
        return None
    inner = None if bone.inner_mm is None else bone.inner_mm - OUTSIDE_MM
    return BoneAhead(bone.outer_mm - OUTSIDE_MM, inner)


def planned_skull_angle_deg(trajectory: ProcedureTrajectory, skull: HeadMesh) -> float | None:
    """Return the angle to the skull's normal where the line meets it; None where it does not."""
    bone = planned_bone(trajectory, skull)
    if bone is None:
        return None
    point = trajectory.entry + bone.outer_mm * trajectory.direction
    return skull_angle_deg(skull, point, trajectory.direction)


def distances_to_no_go(
    trajectory: ProcedureTrajectory, meshes: ProcedureMeshes
) -> dict[str, float]:
    """Return how far the instrument's surface stays from each no-go structure, mm, by name.

    Below 0 the instrument overlaps the structure.
    """
    radius = trajectory.diameter_mm / 2
    return {
        name: axis_distance_mm(mesh, trajectory.entry, trajectory.target) - radius
        for name, mesh in meshes.no_go.items()
    }


def line_distance_mm(one: ProcedureTrajectory, other: ProcedureTrajectory) -> float:
    """Return the distance between the surfaces of two instruments, mm; below 0 they overlap."""
    axes = segment_distances_mm(
        one.entry, one.target, np.array([other.entry]), np.array([other.target])
    )
    return float(axes[0]) - (one.diameter_mm + other.diameter_mm) / 2


def _measured(
    trajectory: ProcedureTrajectory, procedure: Procedure, meshes: ProcedureMeshes
) -> LineMeasures:
    others = {
        other.name: line_distance_mm(trajectory, other)
        for other in procedure.trajectories
        if other is not trajectory
    }
    nearest = min(others, key=others.__getitem__, default="")
    return LineMeasures(
        name=trajectory.name,
        length_mm=trajectory.length_mm,
        skull_angle_deg=planned_skull_angle_deg(trajectory, meshes.skull),
        no_go_mm=distances_to_no_go(trajectory, meshes),
        nearest_line=nearest,
        nearest_line_mm=others.get(nearest),
    )
