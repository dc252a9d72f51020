"""The clearance of the arm's capsules to the head, without querying those that are far."""

from __future__ import annotations

import math
from collections.abc import Sequence
from math import dist

import numpy as np

from rastrainer.errors import InputError
from rastrainer_simulator.collision.capsules import segment_distance, thin_segment
from rastrainer_simulator.collision.clearance import FAR, DistanceBounds, Nearest
from rastrainer_simulator.collision.head_surface import HeadSurface
from rastrainer_simulator.collision.robot_shape import ArmCapsules, PosedArm
from rastrainer_simulator.vectors import ZERO, Vector

_RIGID = 1e-6
_ROUNDING = 1e-9


class HeadClearance:
    """Distances of the tip, the tool and the links to a head with a pose in World.

    No point of a segment moves farther than the farther of its two ends, so a distance found
    earlier, less that motion, is a lower bound now. Only capsules whose bound is below the best
    distance found in this tick are queried. The answer is the same as that of querying all.
    """

    def __init__(self, head: HeadSurface, arm: ArmCapsules) -> None:
        self._head = head
        self._arm = arm
        self._segments = [thin_segment(c.start, c.end) for c in arm.capsules]
        self._bodies = arm.body.tolist()
        self._distance_bounds = DistanceBounds(arm.link_count)
        self.set_pose(np.eye(4))

    def set_pose(self, head_to_world: np.ndarray) -> None:
        """Set the head's pose, HeadToWorld (4, 4) float, m.

        Raises:
            InputError: the matrix is not a rigid transform.
        """
        pose = np.array(head_to_world, dtype=float)
        if pose.shape != (4, 4) or not np.isfinite(pose).all():
            raise InputError("HeadToWorld should be a 4 × 4 matrix of finite numbers.")
        rotation = pose[:3, :3]
        bent = np.abs(rotation @ rotation.T - np.eye(3)).max()
        if bent > _RIGID or np.linalg.det(rotation) < 0.0 or (pose[3] != [0, 0, 0, 1]).any():
            raise InputError("HeadToWorld should be rigid: a rotation and a translation only.")
        self._world_to_head = np.eye(4)
        self._world_to_head[:3, :3] = rotation.T
        self._world_to_head[:3, 3] = -rotation.T @ pose[:3, 3]
        self.base = rotation @ self._head.base + pose[:3, 3]
        """(3,) float: the center of the head's base, World, m."""
        self._middle = rotation @ self._head.middle + pose[:3, 3]
        self._head_to_world_rows = pose[:3].tolist()
        self._world_to_head_rows = self._world_to_head[:3].tolist()
        # What each capsule's clearance was when it was last queried, and where its axis was then.
        self._known = [(-math.inf, ZERO, ZERO)] * len(self._arm.capsules)
        self._distance_bounds.forget()

    def nearest_to_point(self, point: Vector) -> Nearest:
        """Return the point of the head nearest to a point, World, m."""
        return self._in_world(self._head.nearest_to_point(_moved(self._world_to_head_rows, point)))

    def is_crossed(self, start: Vector, end: Vector) -> bool:
        """Return whether the head's surface is between two points, World, m."""
        rows = self._world_to_head_rows
        return self._head.is_crossed(_moved(rows, start), _moved(rows, end))

    def nearest_to_shaft(self, posed: PosedArm, limit: float) -> Nearest | None:
        """Return the point of the head nearest to the shaft, World, m; None beyond `limit`."""
        rows = range(self._arm.link_count, len(self._known))
        found, _ = self._nearest(posed, rows, self._bounds(posed, rows), limit)
        return None if found is None else self._in_world(found)

    def nearest_to_links(self, posed: PosedArm, travelled: float) -> tuple[float, str]:
        """Return the clearance of the links, m, and the nearest of them.

        The clearance is at most FAR, and then no link is named. `travelled` is how far the arm has
        moved in all, m.
        """
        rows = self._distance_bounds.due(travelled)
        if not rows:
            return FAR, ""
        found, nearest = self._nearest(posed, rows, self._bounds(posed, rows), FAR)
        for row, bound in zip(rows, self._bounds(posed, rows), strict=True):
            self._distance_bounds.put_off(row, bound, travelled)
        return (FAR, "") if found is None else (found.distance_m, self._arm.names[nearest])

    def are_links_off(self, posed: PosedArm, clearance: float) -> bool:
        """Return whether every link keeps a clearance, m, to the head."""
        rows = range(self._arm.link_count)
        off_sphere = self._off_sphere(posed)
        bounds = list(map(max, off_sphere, self._bounds(posed, rows, off_sphere)))
        return self._nearest(posed, rows, bounds, clearance)[0] is None

    def _bounds(
        self, posed: PosedArm, rows: Sequence[int], off_sphere: Sequence[float] = ()
    ) -> list[float]:
        """Return a lower bound of the clearance of each of these capsules, m."""
        bounds: list[float] = []
        for row in rows:
            known, start_then, end_then = self._known[row]
            if known == -math.inf:
                # Not queried since the head was moved: use the bounding sphere.
                off_sphere = off_sphere or self._off_sphere(posed)
                bounds.append(off_sphere[row])
                continue
            start, end = posed.axis(row)
            bounds.append(known - max(dist(start, start_then), dist(end, end_then)))
        return bounds

    def _off_sphere(self, posed: PosedArm) -> list[float]:
        """Return a lower bound of each capsule's distance to the head's bounding sphere, m."""
        away = np.linalg.norm(posed.middles - self._middle, axis=1)
        return (away - self._arm.reach - self._head.radius).tolist()

    def _nearest(
        self, posed: PosedArm, rows: Sequence[int], bounds: list[float], limit: float
    ) -> tuple[Nearest | None, int]:
        """Return the point nearest to some capsules, if nearer than `limit`, and that capsule."""
        best, best_row = None, -1
        for bound, row in sorted(zip(bounds, rows, strict=True)):
            if bound >= limit:
                break
            found = self._query(posed, row)
            distance = found.distance_m
            # Of two equally near capsules the first counts, whatever the order of the queries.
            if distance < limit or (distance == limit and row < best_row):
                best, best_row, limit = found, row, distance
        return best, best_row

    def _query(self, posed: PosedArm, row: int) -> Nearest:
        segment, radius = self._segments[row], self._arm.capsules[row].radius
        pose = self._world_to_head @ posed.poses[self._bodies[row]]
        segment.setRotation(pose[:3, :3])
        segment.setTranslation(pose[:3, 3])
        start, end = posed.axis(row)
        rows = self._world_to_head_rows
        found = self._head.nearest_to_segment(
            segment, _moved(rows, start), _moved(rows, end), radius
        )
        self._known[row] = (found.distance_m - _ROUNDING, start, end)
        return found

    def _in_world(self, nearest: Nearest) -> Nearest:
        return Nearest(
            nearest.distance_m,
            _moved(self._head_to_world_rows, nearest.point),
            _turned(self._head_to_world_rows, nearest.normal),
            nearest.triangle,
        )


def _moved(rows: list[list[float]], point: Vector) -> Vector:
    """Return a point under the rigid transform with these three rows."""
    x, y, z = point
    a, b, c = rows
    return (
        a[0] * x + a[1] * y + a[2] * z + a[3],
        b[0] * x + b[1] * y + b[2] * z + b[3],
        c[0] * x + c[1] * y + c[2] * z + c[3],
    )


def _turned(rows: list[list[float]], direction: Vector) -> Vector:
    x, y, z = direction
    a, b, c = rows
    return (
        a[0] * x + a[1] * y + a[2] * z,
        b[0] * x + b[1] * y + b[2] * z,
        c[0] * x + c[1] * y + c[2] * z,
    )


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
