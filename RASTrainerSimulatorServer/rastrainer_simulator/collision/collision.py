"""The clearances of the whole arm, in one call a tick."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rastrainer_simulator.collision.clearance import FAR, Clearance, Nearest
from rastrainer_simulator.collision.head_clearance import HeadClearance
from rastrainer_simulator.collision.head_surface import HeadSurface
from rastrainer_simulator.collision.posed_arm import ArmCapsules, PosedArm
from rastrainer_simulator.collision.robot_shape import RobotShape
from rastrainer_simulator.collision.self_clearance import SelfClearance
from rastrainer_simulator.collision.table_clearance import Surroundings, TableClearance
from rastrainer_simulator.vectors import Vector

_SPACE_DIAGONAL = 1.7320509
"""Of a cube of edge 1, rounded up: a vector is at most so much longer than its longest part."""


class Collision:
    """Tells how near a robot is to the head, to itself, to the table and to the head's stand.

    It works in its own memory: each thread makes its own.
    """

    def __init__(
        self,
        shape: RobotShape,
        head_vertices: np.ndarray,
        head_triangles: np.ndarray,
        surroundings: Surroundings | None = None,
    ) -> None:
        """Build the shapes; takes about half a second for a head of 60,000 triangles.

        Args:
            shape: the robot's capsules.
            head_vertices: (n, 3) float, m, head frame, whose z points to the head's top.
            head_triangles: (m, 3) int, a closed surface.
            surroundings: the table and the head's stand.

        Raises:
            InputError: the head's surface is not closed.
        """
        self._arm = ArmCapsules(shape)
        self._head = HeadClearance(HeadSurface(head_vertices, head_triangles), self._arm)
        self._self = SelfClearance(self._arm)
        surroundings = surroundings or Surroundings()
        self.table_height = surroundings.table_height
        self._table = TableClearance(self._arm, surroundings)
        # Where the arm was when it was last found to be far from itself and all around, and how
        # far each part of it can have moved since without coming near.
        self._far_at = np.zeros((len(self._arm.capsules), 2, 3))
        self._room = 0.0
        self.set_head_pose(np.eye(4))

    def set_head_pose(self, head_to_world: np.ndarray) -> None:
        """Put the head, and the stand under it, where HeadToWorld (4, 4) float, m, says.

        Raises:
            InputError: the matrix is not a rigid transform.
        """
        self._head.set_pose(head_to_world)
        self._table.put_stand_under(self._head.base)
        self._room = 0.0

    def check(self, link_to_world: Mapping[str, np.ndarray]) -> Clearance:
        """Return the clearances of a posture.

        `link_to_world` are the poses (4, 4) float, m, of all links by name, the tool's tip among
        them, as `Kinematics.links` gives them.
        """
        posed = self._arm.pose(link_to_world)
        shaft, links_m, links_worst = self._head.nearest_to_arm(posed)
        self_m, self_worst, table_m, table_worst = self._beside_the_head(posed)
        return Clearance(
            tip=self._head.nearest_to_point(posed.tip),
            shaft=shaft,
            links_m=links_m,
            links_worst=links_worst,
            self_m=self_m,
            self_worst=self_worst,
            table_m=table_m,
            table_worst=table_worst,
        )

    def _beside_the_head(self, posed: PosedArm) -> tuple[float, tuple[str, ...], float, str]:
        """Return what is nearest to the arm of itself, and of table and stand; at most FAR."""
        moved = _SPACE_DIAGONAL * float(np.abs(posed.ends - self._far_at).max())
        if moved < self._room:
            return FAR, (), FAR, ""
        self_m, self_worst = self._self.nearest(posed)
        table_m, table_worst = self._table.nearest(posed)
        # Two parts of the arm may have moved toward each other.
        self._room = min((self_m - FAR) / 2.0, table_m - FAR)
        self._far_at = posed.ends
        return min(self_m, FAR), self_worst, min(table_m, FAR), table_worst

    def nearest_to_point(self, point: Vector) -> Nearest:
        """Return the place of the head nearest to a point, World, m."""
        return self._head.nearest_to_point(point)
