"""Where a trial's head is: truly, which only a simulator knows, and as a registration shows it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.head.trial_head import SkinShift
from rastrainer.journal.entries import RecordedTruth
from rastrainer.json_records import record_to_json
from rastrainer.registration.target_error import true_target_error_mm
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.trial_state import PlannedLine
from rastrainer_simulator.vectors import Vector, dot, in_meters, scale, subtract, vector

if TYPE_CHECKING:
    from rastrainer.procedure.plan import Checkpoint, ProcedureTrajectory
    from rastrainer.scenario.points import Task
    from rastrainer.scenario.scenario import Scenario


class Truth(RecordedTruth):
    """True pose of the head. Hidden from clients until the trial's registration is final."""

    def in_world(self, points: np.ndarray) -> np.ndarray:
        """Return a point of the head, or n of them, (3,) or (n, 3) float, RAS mm, in World, mm."""
        return points @ self.head_to_world[:3, :3].T + self.head_to_world[:3, 3]

    def in_head(self, point: np.ndarray) -> np.ndarray:
        return self.head_to_world[:3, :3].T @ (point - self.head_to_world[:3, 3])

    def touch_errors_mm(
        self, touches: Iterable[tuple[str, tuple[float, float, float]]]
    ) -> dict[str, float]:
        """Return for each touch (label, World mm) how far it is from its fiducial, in mm."""
        return {
            label: float(
                np.linalg.norm(self.in_head(np.array(position)) - self.fiducials_ras[label])
            )
            for label, position in touches
        }

    def revealed(
        self, matrix: Sequence[float], touches: Iterable[tuple[str, tuple[float, float, float]]]
    ) -> dict[str, Any]:
        """Return the data of the answer to SubmitRegistration, ready for JSON.

        `matrix` is WorldToHead, 16 floats, mm. The true TRE is |WorldToHead · HeadToWorld(target) −
        target|, mm.
        """
        world_to_head = np.array(matrix, dtype=float).reshape(4, 4)
        tre_mm = true_target_error_mm(world_to_head, self.head_to_world, self.target_ras)
        return {
            "headToWorld": [float(value) for value in self.head_to_world.ravel()],
            "trueTreMm": tre_mm,
            "touchErrorsMm": self.touch_errors_mm(touches),
            **({} if self.skin.is_none else {"skin": record_to_json(self.skin)}),
        }


@dataclass(frozen=True, eq=False)
class PlacedHead:
    """A head in World, as the tip meets it; `fiducials` (World, m) belong to a trial's task."""

    truth: Truth
    fiducials: Mapping[str, Vector] = field(default_factory=dict)
    _mesh: HeadMesh | None = None

    @classmethod
    def nominal(cls, scenario: Scenario) -> PlacedHead:
        """Return the head between trials, where the scenario puts it."""
        return cls(Truth(scenario.head_to_world, scenario.target.position_ras, {}))

    @classmethod
    def of_trial(cls, scenario: Scenario, task: Task, seed: int, skin: SkinShift) -> PlacedHead:
        """Return the head of a trial, moved and with its skin shifted by the trial's seed."""
        mesh = None if skin.is_none else read_head_mesh(scenario.head)
        shifted = skin if skin.is_none else replace(skin, seed=seed)
        points = dict(zip(task.labels, task.fiducials, strict=True))
        pose = scenario.perturbed_head_to_world(seed)
        truth = Truth(pose, scenario.target.position_ras, points, shifted)
        places = truth.in_world(np.array(list(truth.fiducials_ras.values()))) / MM_PER_M
        fiducials = dict(zip(truth.fiducials_ras, map(tuple, places.tolist()), strict=True))
        return cls(truth, fiducials, mesh)

    def measured(self, tip: Vector) -> Vector:
        """Return where a tip is measured that the skin has shifted with, World, m."""
        if self._mesh is None:
            return tip
        truth, place = self.truth, self.truth.in_head(MM_PER_M * np.array(tip))
        return in_meters(truth.in_world(truth.skin.measured(place[None], self._mesh)[0]))


RIGID_WITHIN = 1e-6
"""How far the rotation of a rigid transform may be from an orthonormal one."""


@dataclass(frozen=True)
class RegisteredPlan:
    """A rigid WorldToHead transform in mm, which shows the plan: rotation by rows, and translation.

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
        scaled = scale(position, MM_PER_M)
        return vector(
            dot(row, scaled) + shift for row, shift in zip(self.rows, self.shift, strict=True)
        )

    def line(self, trajectory: ProcedureTrajectory) -> PlannedLine:
        entry, target = trajectory.entry_ras.tolist(), trajectory.target_ras.tolist()
        return PlannedLine(trajectory.name, self.in_world(entry), self.in_world(target))

    def nearest_checkpoint(
        self, checkpoints: Iterable[Checkpoint], tip: Vector
    ) -> tuple[str, float]:
        """Return the checkpoint nearest to a tip (World, m), and its distance, m."""
        here = self.in_head(tip)
        distance, name = min(
            (math.dist(here, each.position_ras.tolist()) / MM_PER_M, each.name)
            for each in checkpoints
        )
        return name, distance
