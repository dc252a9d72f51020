"""The clearances of the arm, when to measure them again, and the clearances to the head."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from heapq import heapify, heappop, heappush
from math import dist
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer_simulator.collision.head_surface import HeadSurface, Nearest, thin_segment
from rastrainer_simulator.collision.robot_shape import ArmCapsules, PosedArm
from rastrainer_simulator.vectors import ZERO, Vector

FAR = 0.1
"""Clearances of links, self and table are exact up to this value, m, which is their maximum."""

SHAFT_NEAR = 0.0015
"""The shaft's clearance is exact up to this value, m, and where it is less than the tip's."""


class Clearance(NamedTuple):
    """Signed clearances of one posture, in m (below zero: overlap); points and normals in World.

    `tip` is the very tip of the tool against the head, `shaft` the rest of the tool from 3 mm
    behind the tip, None unless it is near (`SHAFT_NEAR`); `shaft_m` is then a lower bound, and
    `tool_m` the clearance of the whole tool. The others are at most FAR: the links against the
    head, the arm against itself, and arm and tool against table and stand.
    """

    tip: Nearest
    shaft: Nearest | None
    shaft_m: float
    tool_m: float
    links_m: float
    self_m: float
    table_m: float

    @property
    def tip_m(self) -> float:
        return self.tip.distance_m


_ROUGHLY_FAR = 0.2
"""Distances whose rough bound is above this, m, are not measured exactly."""

_FEW = 4
"""If more than this are due, the arm has jumped: rough bounds of all are quicker."""

_ROUNDING = 1e-6


class DistanceBounds:
    """Keeps track of which of n distances may be below FAR.

    A distance d cannot fall below FAR before the arm has moved by d − FAR: until then it is not
    measured again. So most ticks measure nothing, and hardly any tick many.
    """

    def __init__(self, count: int, closing: float = 1.0) -> None:
        """Track `count` distances, each of which shrinks at most by `closing` m per meter."""
        self._count = count
        self._closing = closing
        self.forget()

    def forget(self) -> None:
        """Make all due, for example after something other than the arm has moved."""
        self._due = [(-1.0, row) for row in range(self._count)]

    def due(self, traveled: float, rough: Callable[[], np.ndarray] | None = None) -> list[int]:
        """Return the rows that may be below FAR, rising; each must then be `put_off`.

        `traveled` is the total motion of the arm, m; `rough` gives a lower bound of each distance,
        (count,) float, m.
        """
        due, rows = self._due, []
        while due and due[0][0] <= traveled:
            rows.append(heappop(due)[1])
            if rough is not None and len(rows) > _FEW:
                # Put off all due rows that are far.
                rows += [row for moment, row in due if moment <= traveled]
                bounds = rough()
                until = (traveled + (bounds - FAR - _ROUNDING) / self._closing).tolist()
                far = (bounds >= _ROUGHLY_FAR).tolist()
                waiting = [entry for entry in due if entry[0] > traveled]
                self._due = [*waiting, *((until[row], row) for row in rows if far[row])]
                heapify(self._due)
                rows = [row for row in rows if not far[row]]
                break
        rows.sort()
        return rows

    def put_off(self, row: int, distance: float, traveled: float) -> None:
        """Make a row due again when it may be below FAR; it is now at least `distance`, m."""
        until = traveled + (distance - FAR - _ROUNDING) / self._closing
        heappush(self._due, (until, row))


_RIGID = 1e-6
_QUERY_ROUNDING = 1e-9


class HeadClearance:
    """Distances of the tip, the tool and the links to a head with a pose in World.

    No point of a segment moves farther than the farther of its two ends, so a distance found
    earlier, less that motion, is a lower bound now. Only capsules whose bound is below the best
    distance found in this tick are queried. Querying all of them would give the same answer.
    """

    def __init__(self, head: HeadSurface, arm: ArmCapsules) -> None:
        self._head = head
        self._arm = arm
        self._segments = [thin_segment(c.start, c.end) for c in arm.capsules]
        self._bodies = arm.body.tolist()
        self._distance_bounds = DistanceBounds(arm.link_count)
        self.set_pose(np.eye(4))

    def set_pose(self, head_to_world: np.ndarray) -> None:
        pose = np.array(head_to_world, dtype=float)
        rotation = pose[:3, :3]
        is_orthogonal = np.abs(rotation @ rotation.T - np.eye(3)).max() <= _RIGID
        if not is_orthogonal or np.linalg.det(rotation) < 0.0:
            raise InputError("HeadToWorld should be rigid: a rotation and a translation only.")
        self._world_to_head = transforms.rigid(rotation.T, -rotation.T @ pose[:3, 3])
        self.base = rotation @ self._head.base + pose[:3, 3]
        """(3,) float: the center of the head's base, World, m."""
        self._middle = rotation @ self._head.middle + pose[:3, 3]
        self._head_to_world_rows = pose[:3].tolist()
        self._world_to_head_rows = self._world_to_head[:3].tolist()
        # What each capsule's clearance was when it was last queried, and where its axis was then.
        self._known = [(-math.inf, ZERO, ZERO)] * len(self._arm.capsules)
        self._distance_bounds.forget()

    def nearest_to_point(self, point: Vector) -> Nearest:
        return self._in_world(self._head.nearest_to_point(_moved(self._world_to_head_rows, point)))

    def are_crossed(self, starts: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Return from which points (n, 3) the head's surface is before another, (n,) bool.

        The other is (3,); World, m.
        """
        to_head = self._world_to_head
        return self._head.are_crossed(
            transforms.apply(to_head, starts), transforms.apply(to_head, end)
        )

    def nearest_to_shaft(self, posed: PosedArm, limit: float) -> Nearest | None:
        """Return the point of the head nearest to the shaft, World, m; None beyond `limit`."""
        rows = range(self._arm.link_count, len(self._known))
        found = self._nearest(posed, rows, self._bounds(posed, rows), limit)
        return None if found is None else self._in_world(found)

    def nearest_to_links(self, posed: PosedArm, traveled: float) -> float:
        """Return the clearance of the links, m, at most FAR.

        `traveled` is how far the arm has moved in all, m.
        """
        rows = self._distance_bounds.due(traveled)
        if not rows:
            return FAR
        found = self._nearest(posed, rows, self._bounds(posed, rows), FAR)
        for row, bound in zip(rows, self._bounds(posed, rows), strict=True):
            self._distance_bounds.put_off(row, bound, traveled)
        return FAR if found is None else found.distance_m

    def are_links_off(self, posed: PosedArm, clearance: float) -> bool:
        """Return whether every link keeps a clearance, m, to the head."""
        rows = range(self._arm.link_count)
        off_sphere = self._off_sphere(posed)
        bounds = list(map(max, off_sphere, self._bounds(posed, rows, off_sphere)))
        return self._nearest(posed, rows, bounds, clearance) is None

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
            start, end = posed.ends[row].tolist()
            bounds.append(known - max(dist(start, start_then), dist(end, end_then)))
        return bounds

    def _off_sphere(self, posed: PosedArm) -> list[float]:
        """Return a lower bound of each capsule's distance to the head's bounding sphere, m."""
        away = np.linalg.norm(posed.middles - self._middle, axis=1)
        return (away - self._arm.reach - self._head.radius).tolist()

    def _nearest(
        self, posed: PosedArm, rows: Sequence[int], bounds: list[float], limit: float
    ) -> Nearest | None:
        """Return the point nearest to some capsules, if nearer than `limit`."""
        best, best_row = None, -1
        to_head = self._world_to_head_rows
        for bound, row in sorted(zip(bounds, rows, strict=True)):
            if bound >= limit:
                break
            segment, radius = self._segments[row], self._arm.capsules[row].radius
            pose = self._world_to_head @ posed.poses[self._bodies[row]]
            segment.setRotation(pose[:3, :3])
            segment.setTranslation(pose[:3, 3])
            start, end = posed.ends[row].tolist()
            found = self._head.nearest_to_segment(
                segment, _moved(to_head, start), _moved(to_head, end), radius
            )
            distance = found.distance_m
            self._known[row] = (distance - _QUERY_ROUNDING, start, end)
            # The first of two equally near capsules counts, in any order of the queries.
            if distance < limit or (distance == limit and row < best_row):
                best, best_row, limit = found, row, distance
        return best

    def _in_world(self, nearest: Nearest) -> Nearest:
        x, y, z = nearest.normal
        a, b, c = self._head_to_world_rows
        return Nearest(
            nearest.distance_m,
            _moved(self._head_to_world_rows, nearest.point),
            (
                a[0] * x + a[1] * y + a[2] * z,
                b[0] * x + b[1] * y + b[2] * z,
                c[0] * x + c[1] * y + c[2] * z,
            ),
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


ABOVE_TABLE_M = 0.02
"""An eye nearer to the table than this would look through its top."""
_TINY = 1e-12


def sight_clearances(
    eyes: np.ndarray, places: np.ndarray, ends: np.ndarray, radii: np.ndarray
) -> np.ndarray:
    """Return how far m lines of sight pass n capsules, (m, n) float, m; below zero: covered.

    Lines begin at `eyes` and end at `places`, (m, 3) float each; `ends` (n, 2, 3) and `radii` (n,)
    are the capsules'. It is `vectors.segment_distance` for all pairs at once.
    """
    starts, axes = ends[:, 0], ends[:, 1] - ends[:, 0]
    lines = places - eyes
    uu = np.einsum("mi,mi->m", lines, lines)[:, None] + _TINY
    vv = np.einsum("ni,ni->n", axes, axes) + _TINY
    uv = lines @ axes.T
    between = eyes[:, None] - starts
    uw = np.einsum("mi,mni->mn", lines, between)
    vw = np.einsum("ni,mni->mn", axes, between)
    area = np.maximum(uu * vv - uv * uv, _TINY * uu * vv)
    s = np.clip((uv * vw - vv * uw) / area, 0.0, 1.0)
    t = np.clip((uv * s + vw) / vv, 0.0, 1.0)
    s = np.clip((uv * t - uw) / uu, 0.0, 1.0)
    apart = between + s[..., None] * lines[:, None] - t[..., None] * axes
    return np.sqrt(np.einsum("mni,mni->mn", apart, apart)) - radii


class LineOfSight:
    """Finds what the head, the table and one posture of the arm leave visible; World, m."""

    def __init__(self, head: HeadClearance, arm: ArmCapsules, posed: PosedArm) -> None:
        self._head = head
        count = arm.link_count
        self._links = posed.ends[:count], arm.radii[:count]
        self._tool = posed.ends[count:], arm.radii[count:]

    def is_free(self, eye: Vector, place: Vector) -> bool:
        """Return whether a point is seen from an eye past head, links and table.

        The tool does not count.
        """
        eyes = np.array([eye])
        return bool(self.is_past_head(eyes, place)[0] and self.off_links(eyes, place)[0] > 0.0)

    def is_past_head(self, eyes: np.ndarray, place: ArrayLike) -> np.ndarray:
        """Return from which eyes (n, 3) a place (3,) is seen past head and table, (n,) bool."""
        return (eyes[:, 2] > ABOVE_TABLE_M) & ~self._head.are_crossed(eyes, np.asarray(place))

    def off_links(self, eyes: np.ndarray, place: ArrayLike) -> np.ndarray:
        """Return how far the lines from eyes (m, 3) to a place (3,) pass the links, (m,), m."""
        return sight_clearances(eyes, np.broadcast_to(place, eyes.shape), *self._links).min(axis=1)

    def off_tool(self, eyes: np.ndarray, place: ArrayLike) -> np.ndarray:
        """Return how far the lines from eyes (m, 3) to a place (3,) pass the tool, (m,), m."""
        return sight_clearances(eyes, np.broadcast_to(place, eyes.shape), *self._tool).min(axis=1)
