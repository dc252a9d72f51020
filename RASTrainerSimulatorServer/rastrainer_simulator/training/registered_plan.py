"""The plan as a registration shows it: in plain arithmetic, equal on every computer."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.trial_state import PlannedLine
from rastrainer_simulator.vectors import Vector, dot, scale, subtract, vector

if TYPE_CHECKING:
    from rastrainer.procedure.plan import Checkpoint, ProcedureTrajectory

RIGID_WITHIN = 1e-6
"""How far the rotation of a rigid transform may be from an orthonormal one."""


@dataclass(frozen=True)
class RegisteredPlan:
    """A rigid WorldToHead transform in mm: its rotation by rows, and its translation.

    No numpy: its linear algebra differs from build to build in the last bit, and a trial is played
    again to the last bit.
    """

    rows: tuple[Vector, Vector, Vector]
    shift: Vector

    @classmethod
    def of(cls, matrix: Sequence[float]) -> RegisteredPlan | None:
        """Return the plan by a WorldToHead matrix, 16 floats row by row, mm; None if not rigid."""
        rows = tuple(vector(matrix[start : start + 3]) for start in (0, 4, 8))
        a, b, c = rows
        products = (dot(a, b), dot(b, c), dot(c, a), dot(a, a) - 1, dot(b, b) - 1, dot(c, c) - 1)
        x, y, z = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
        is_rotation = max(map(abs, products)) <= RIGID_WITHIN and dot((x, y, z), c) > 0.0
        if not is_rotation or tuple(matrix[12:]) != (0.0, 0.0, 0.0, 1.0):
            return None
        return cls((a, b, c), (matrix[3], matrix[7], matrix[11]))

    def in_world(self, point: Iterable[float]) -> Vector:
        """Return a point of the MRI, RAS mm, in World, m."""
        x, y, z = subtract(vector(point), self.shift)
        return vector(
            (x * self.rows[0][axis] + y * self.rows[1][axis] + z * self.rows[2][axis]) / MM_PER_M
            for axis in range(3)
        )

    def in_head(self, position: Vector) -> Vector:
        """Return a point of World, m, in the MRI, RAS mm."""
        scaled = scale(position, MM_PER_M)
        return vector(
            dot(row, scaled) + shift for row, shift in zip(self.rows, self.shift, strict=True)
        )

    def line(self, trajectory: ProcedureTrajectory) -> PlannedLine:
        """Return a planned trajectory in World."""
        entry, target = trajectory.entry.tolist(), trajectory.target.tolist()
        return PlannedLine(trajectory.name, self.in_world(entry), self.in_world(target))

    def nearest_checkpoint(
        self, checkpoints: Iterable[Checkpoint], tip: Vector
    ) -> tuple[str, float]:
        """Return the checkpoint nearest to a tip (World, m), and its distance, m."""
        here = self.in_head(tip)
        distance, name = min(
            (math.dist(here, each.position.tolist()) / MM_PER_M, each.name) for each in checkpoints
        )
        return name, distance
