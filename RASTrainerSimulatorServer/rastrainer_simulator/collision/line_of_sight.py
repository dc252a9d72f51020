"""What hides one place from another: the head, the arm and the table, as collisions see them."""

from __future__ import annotations

from rastrainer_simulator.collision.capsules import segment_distance
from rastrainer_simulator.collision.head_clearance import HeadClearance
from rastrainer_simulator.collision.robot_shape import ArmCapsules, PosedArm
from rastrainer_simulator.vectors import Vector

ABOVE_TABLE_M = 0.02
"""An eye nearer to the table than this would look through its top."""


class LineOfSight:
    """Finds whether points can be seen past the head and one posture of the arm."""

    def __init__(
        self, head: HeadClearance, arm: ArmCapsules, posed: PosedArm, table_height: float
    ) -> None:
        self._head = head
        self._posed = posed
        self._radii = arm.radii.tolist()
        self._link_count = arm.link_count
        self._lowest = table_height + ABOVE_TABLE_M

    def is_free(self, eye: Vector, place: Vector, margin: float = 0.0) -> bool:
        """Return whether a place is seen from an eye past head, links and table; World, m.

        The links are thicker by `margin`, m. The tool does not count.
        """
        rows = range(self._link_count)
        is_clear = eye[2] > self._lowest and self._are_off(eye, place, rows, margin)
        return is_clear and not self._head.is_crossed(eye, place)

    def is_past_tool(self, eye: Vector, place: Vector) -> bool:
        """Return whether the tool leaves a place to be seen from an eye; World, m."""
        return self._are_off(eye, place, range(self._link_count, len(self._radii)), 0.0)

    def _are_off(self, eye: Vector, place: Vector, rows: range, margin: float) -> bool:
        return all(
            segment_distance(eye, place, *self._posed.axis(row)) > self._radii[row] + margin
            for row in rows
        )
