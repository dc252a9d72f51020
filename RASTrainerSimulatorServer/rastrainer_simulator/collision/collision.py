"""The clearances of the whole arm, in one call a tick."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial

import numpy as np

from rastrainer import transforms
from rastrainer.head.mesh import HeadMesh
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.clearance import (
    FAR,
    SHAFT_NEAR,
    Clearance,
    DistanceBounds,
    HeadClearance,
    LineOfSight,
)
from rastrainer_simulator.collision.head_surface import HeadSurface, Nearest
from rastrainer_simulator.collision.robot_shape import ArmCapsules, PosedArm, RobotShape
from rastrainer_simulator.vectors import segment_distance


def stand_pose(head_to_world: np.ndarray, base: np.ndarray) -> np.ndarray:
    """Return StandToWorld, (4, 4) float, m; `base` is the middle of the head's base, (3,) float."""
    return transforms.rigid(np.eye(3), head_to_world[:3, :3] @ base + head_to_world[:3, 3])


class TableClearance:
    """The least distance of the moving links and the tool to the table and to the stand."""

    def __init__(self, arm: ArmCapsules, stand_radius: float) -> None:
        self._arm = arm
        self._stand_radius = stand_radius
        self._stand: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None
        self._distance_bounds = DistanceBounds(len(arm.capsules))
        fixed = np.where(arm.joints > 0, 0.0, -math.inf)
        self._below = arm.radii + fixed
        self._around = arm.reach + stand_radius + fixed

    def put_stand_under(self, base: np.ndarray) -> None:
        """Put the stand under the middle of the head's base (3,) float, World."""
        x, y, top = base.tolist()
        top -= self._stand_radius  # The column is a capsule: its round end fills up to the base.
        upright = self._stand_radius > 0.0 and top > 0.0
        self._stand = ((x, y, 0.0), (x, y, top)) if upright else None
        self._distance_bounds.forget()

    def nearest(self, posed: PosedArm, traveled: float) -> float:
        """Return the least signed distance, m, at most FAR; the arm has moved `traveled` m."""
        # The tip is no part of a capsule.
        best = min(FAR, posed.tip[2])
        for row in self._distance_bounds.due(traveled, partial(self._bounds, posed)):
            start, end = posed.ends[row].tolist()
            distance = min(start[2], end[2]) - self._below[row]
            if self._stand is not None:
                radii = self._arm.capsules[row].radius + self._stand_radius
                distance = min(distance, segment_distance(start, end, *self._stand) - radii)
            self._distance_bounds.put_off(row, distance, traveled)
            best = min(best, distance)
        return best

    def _bounds(self, posed: PosedArm) -> np.ndarray:
        """Return a lower bound of the distance of each capsule, (n,) float, m."""
        bounds = np.minimum(posed.ends[:, 0, 2], posed.ends[:, 1, 2]) - self._below
        if self._stand is None:
            return bounds
        away = posed.middles - self._stand[1]
        np.maximum(away[:, 2], 0.0, out=away[:, 2])
        return np.minimum(bounds, np.sqrt(np.einsum("ij,ij->i", away, away)) - self._around)


APART = 3
"""Links this many joints apart are checked; joint limits keep nearer links from touching."""


class SelfClearance:
    """The least distance between links that could touch each other."""

    def __init__(self, arm: ArmCapsules) -> None:
        first, second = np.triu_indices(len(arm.capsules), k=1)
        apart = np.abs(arm.joints[first] - arm.joints[second]) >= APART
        self._first, self._second = first[apart], second[apart]
        self._pairs = list(zip(self._first.tolist(), self._second.tolist(), strict=True))
        self._reaches = arm.reach[self._first] + arm.reach[self._second]
        self._radii = (arm.radii[self._first] + arm.radii[self._second]).tolist()
        # Both links of a pair may move toward each other.
        self._distance_bounds = DistanceBounds(len(self._pairs), closing=2.0)

    def nearest(self, posed: PosedArm, traveled: float) -> float:
        """Return the least signed distance, m, at most FAR; the arm has moved `traveled` m."""
        best = FAR
        for pair in self._distance_bounds.due(traveled, partial(self._bounds, posed)):
            first, second = self._pairs[pair]
            ends = *posed.ends[first].tolist(), *posed.ends[second].tolist()
            distance = segment_distance(*ends) - self._radii[pair]
            self._distance_bounds.put_off(pair, distance, traveled)
            best = min(best, distance)
        return best

    def _bounds(self, posed: PosedArm) -> np.ndarray:
        """Return a lower bound of the distance of each pair, (pairs,) float, m."""
        middles = posed.middles
        between = middles.take(self._first, 0) - middles.take(self._second, 0)
        return np.sqrt(np.einsum("ij,ij->i", between, between)) - self._reaches


class Collision:
    """Computes how near a robot is to the head, to itself, to the table and to the head's stand.

    It works in its own memory: each thread makes its own.
    """

    def __init__(
        self,
        shape: RobotShape,
        head_vertices: np.ndarray,
        head_triangles: np.ndarray,
        stand_radius: float = 0.04,
    ) -> None:
        """Build the shapes; takes about half a second for a head of 60,000 triangles.

        The head, (n, 3) float, m, and (m, 3) int, is closed, and its z points to its top. A column
        of `stand_radius`, m, is under the middle of its base; 0: no stand. The table top is at z =
        0; the robot's base is fixed to it and is not checked.
        """
        self._arm = ArmCapsules(shape)
        self._head = HeadClearance(HeadSurface(head_vertices, head_triangles), self._arm)
        self.nearest_to_point = self._head.nearest_to_point
        self._self = SelfClearance(self._arm)
        self._table = TableClearance(self._arm, stand_radius)
        self._ends = np.zeros((len(self._arm.capsules), 2, 3))
        self._traveled = 0.0
        self.set_head_pose(np.eye(4))

    def set_head_pose(self, head_to_world: np.ndarray) -> None:
        """Set the pose of the head, HeadToWorld (4, 4) float, m, and move the stand under it."""
        self._head.set_pose(head_to_world)
        self._table.put_stand_under(self._head.base)

    def check(self, link_to_world: Mapping[str, np.ndarray]) -> Clearance:
        """Return the clearances of a posture.

        `link_to_world` are the poses (4, 4) float, m, of all links by name, the tool's tip among
        them, as `Kinematics.links` gives them.
        """
        posed = self._arm.pose(link_to_world)
        traveled = self._travel(posed)
        tip = self._head.nearest_to_point(posed.tip)
        far = max(tip.distance_m, SHAFT_NEAR)
        shaft = self._head.nearest_to_shaft(posed, far)
        shaft_m = far if shaft is None else shaft.distance_m
        return Clearance(
            tip,
            shaft,
            shaft_m,
            min(tip.distance_m, shaft_m),
            self._head.nearest_to_links(posed, traveled),
            self._self.nearest(posed, traveled),
            self._table.nearest(posed, traveled),
        )

    def is_clear(self, link_to_world: Mapping[str, np.ndarray], clearance: float) -> bool:
        """Return whether everything but the tip keeps its clearance.

        The tool's shaft is off the head; the links are at least `clearance`, m, from the head, and
        the arm from itself, the table and the stand. It stops at the first part too near.
        """
        posed = self._arm.pose(link_to_world)
        traveled = self._travel(posed)
        return (
            self._table.nearest(posed, traveled) >= clearance
            and self._head.nearest_to_shaft(posed, 0.0) is None
            and self._head.are_links_off(posed, clearance)
            and self._self.nearest(posed, traveled) >= clearance
        )

    def _travel(self, posed: PosedArm) -> float:
        """Return how far the arm has moved in all, m: in each tick its fastest point counts."""
        moved = posed.ends - self._ends
        self._ends = posed.ends
        self._traveled += math.sqrt(np.einsum("ijk,ijk->ij", moved, moved).max())
        return self._traveled

    def line_of_sight(self, link_to_world: Mapping[str, np.ndarray]) -> LineOfSight:
        """Return what determines which points are seen while the arm has such a posture."""
        return LineOfSight(self._head, self._arm, self._arm.pose(link_to_world))

    def nearest_to_shaft(
        self, link_to_world: Mapping[str, np.ndarray], limit: float
    ) -> Nearest | None:
        """Return the place of the head nearest to the shaft; None if none is within `limit`."""
        return self._head.nearest_to_shaft(self._arm.pose(link_to_world), limit)


def head_collision(shape: RobotShape, head: HeadMesh, scenario: Scenario) -> Collision:
    """Return what measures a robot against a head, RAS mm, and the table and stand around it."""
    stand_radius = scenario.stand.diameter_mm / 2.0 / MM_PER_M
    return Collision(shape, head.vertices / MM_PER_M, head.triangles, stand_radius)
