"""The clearances of the whole arm, in one call a tick."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

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
_NOTHING = (False, False, False)


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
        # For the head, the arm itself and the table: where the arm was when last asked about, and
        # how far each capsule may have moved since, along each axis, without coming near.
        self._far_at = np.zeros((3, len(self._arm.capsules), 2, 3))
        self._room = np.zeros((3, len(self._arm.capsules), 1, 1))
        self.set_head_pose(np.eye(4))

    def set_head_pose(self, head_to_world: np.ndarray) -> None:
        """Put the head, and the stand under it, where HeadToWorld (4, 4) float, m, says.

        Raises:
            InputError: the matrix is not a rigid transform.
        """
        self._head.set_pose(head_to_world)
        self._table.put_stand_under(self._head.base)
        self._room[:] = 0.0

    def check(self, link_to_world: Mapping[str, np.ndarray]) -> Clearance:
        """Return the clearances of a posture.

        `link_to_world` are the poses (4, 4) float, m, of all links by name, the tool's tip among
        them, as `Kinematics.links` gives them.
        """
        posed = self._arm.pose(link_to_world)
        return Clearance(
            self._head.nearest_to_point(posed.tip),
            self._head.nearest_to_shaft(posed),
            *self._links(posed),
        )

    def is_clear(self, link_to_world: Mapping[str, np.ndarray], clearance: float) -> bool:
        """Tell whether the tip can be anywhere, as far as all else is concerned.

        The tool's shaft is off the head, and the links are at least `clearance`, m, from the head,
        and the arm from itself, the table and the stand. It is what `check` would say, but at the
        first that is too near no other is asked.
        """
        posed = self._arm.pose(link_to_world)
        return (
            self._of_table(posed, is_due=True)[0] >= clearance
            and self._head.nearest_to_shaft(posed).distance_m > 0.0
            and self._head.are_links_off(posed, clearance)
            and self._of_itself(posed, is_due=True)[0] >= clearance
        )

    def _links(self, posed: PosedArm) -> tuple[float, str, float, tuple[str, ...], float, str]:
        """Return what is nearest to the links of the head, of the arm, and of table and stand."""
        near_head, near_itself, near_table = self._may_be_near(posed)
        links = FAR, ""
        if near_head:
            *links, bounds = self._head.nearest_to_links(posed)
            self._keep(0, posed, bounds - FAR)
        return (*links, *self._of_itself(posed, near_itself), *self._of_table(posed, near_table))

    def _may_be_near(self, posed: PosedArm) -> Sequence[bool]:
        """Tell of head, arm and table whether something that was far may have come near."""
        has_moved = np.abs(posed.ends - self._far_at) >= self._room
        # In most ticks nothing has: one question is quicker than three.
        return has_moved.any(axis=(1, 2, 3)).tolist() if has_moved.any() else _NOTHING

    def _of_itself(self, posed: PosedArm, is_due: bool) -> tuple[float, tuple[str, ...]]:
        if is_due:
            # Two parts of the arm may move toward each other.
            self._keep(1, posed, (self._self.look(posed) - FAR) / 2.0)
        return self._self.nearest(posed)

    def _of_table(self, posed: PosedArm, is_due: bool) -> tuple[float, str]:
        if is_due:
            self._keep(2, posed, self._table.look(posed) - FAR)
        return self._table.nearest(posed)

    def _keep(self, part: int, posed: PosedArm, room: np.ndarray) -> None:
        self._far_at[part] = posed.ends
        self._room[part, :, 0, 0] = room / _SPACE_DIAGONAL

    def nearest_to_point(self, point: Vector) -> Nearest:
        """Return the place of the head nearest to a point, World, m."""
        return self._head.nearest_to_point(point)
