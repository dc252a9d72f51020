"""Exact signed distances to the head, in the head's frame."""

from __future__ import annotations

import math
from functools import lru_cache

import fcl
import numpy as np

from rastrainer_simulator.collision.capsules import thin_segment
from rastrainer_simulator.collision.clearance import Nearest
from rastrainer_simulator.collision.closed_surface import ClosedSurface
from rastrainer_simulator.vectors import Vector

_REQUEST = fcl.DistanceRequest(enable_nearest_points=True)
_ANY = fcl.CollisionRequest()
# Nearer than this, the line to the nearest point has no direction of its own.
_TOUCHING = 1e-9
_BASE_THICKNESS = 0.001


class HeadSurface:
    """The head as a bounding volume hierarchy of its triangles, and as a closed surface.

    fcl gives the exact distance without sign; the sign is that of the pseudonormal at the nearest
    point. All lengths in m, all points in the head's frame.
    """

    def __init__(self, vertices: np.ndarray, triangles: np.ndarray) -> None:
        """Take (n, 3) float vertices and (m, 3) int triangles.

        The last surface is cached.

        Raises:
            InputError: the surface is not closed, or holds unusable numbers.
        """
        self._surface, mesh = _shapes(_Numbers(vertices), _Numbers(triangles))
        vertices = self._surface.vertices
        base = vertices[vertices[:, 2] <= vertices[:, 2].min() + _BASE_THICKNESS]
        self.base = (base.min(axis=0) + base.max(axis=0)) / 2.0
        """(3,) float: the middle of the lowest millimetre, on which the head is."""
        self.middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2.0
        """(3,) float: the middle of the sphere around the whole head."""
        self.radius = float(np.linalg.norm(vertices - self.middle, axis=1).max())
        """The radius of that sphere."""
        self._head = fcl.CollisionObject(mesh)
        self._point = thin_segment(np.zeros(3), np.zeros(3))

    def nearest_to_point(self, point: Vector) -> Nearest:
        """Return the nearest place of the surface, the distance below zero inside the head."""
        position = np.array(point)
        self._point.setTranslation(position)
        distance, on_head, triangle = self._query(self._point)
        if distance <= 0.0:  # fcl sets no nearest points where shapes meet.
            on_head = position
        return self._signed(point, distance, on_head, triangle)

    def nearest_to_segment(
        self, segment: fcl.CollisionObject, start: Vector, end: Vector, radius: float
    ) -> Nearest:
        """Return the place of the surface nearest to a capsule.

        `segment` is its axis from `start` to `end`, its pose already set. Where the axis itself
        goes through the surface, the distance is −radius: at least so deep is the capsule.
        """
        distance, on_head, triangle = self._query(segment)
        if distance <= 0.0:
            point, normal = self._surface.crossing(triangle, start, end)
            return Nearest(-radius, point, normal, triangle)
        return self._signed(_foot(start, end, on_head), distance, on_head, triangle, radius)

    def is_crossed(self, start: Vector, end: Vector) -> bool:
        """Return whether the segment between two points goes through the surface."""
        segment = thin_segment(np.array(start), np.array(end))
        return fcl.collide(self._head, segment, _ANY, fcl.CollisionResult()) > 0

    def _query(self, other: fcl.CollisionObject) -> tuple[float, np.ndarray, int]:
        result = fcl.DistanceResult()
        distance = fcl.distance(self._head, other, _REQUEST, result)
        return distance, result.nearest_points[0], result.b1

    def _signed(
        self,
        point: Vector,
        distance: float,
        on_head: np.ndarray,
        triangle: int,
        radius: float = 0.0,
    ) -> Nearest:
        nx, ny, nz = self._surface.pseudonormal(triangle, on_head)
        x, y, z = foot = tuple(on_head.tolist())
        dx, dy, dz = point[0] - x, point[1] - y, point[2] - z
        if nx * dx + ny * dy + nz * dz < 0.0:
            distance = -distance
        if abs(distance) < _TOUCHING:
            size = math.sqrt(nx * nx + ny * ny + nz * nz)
            normal = (nx / size, ny / size, nz / size)
        else:
            normal = (dx / distance, dy / distance, dz / distance)
        return Nearest(distance - radius, foot, normal, triangle)


class _Numbers:
    """An array that equals another where all its numbers do."""

    def __init__(self, array: np.ndarray) -> None:
        self.array = np.array(array)
        self._content = (self.array.shape, self.array.dtype.str, self.array.tobytes())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Numbers) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)


@lru_cache(maxsize=1)
def _shapes(vertices: _Numbers, triangles: _Numbers) -> tuple[ClosedSurface, fcl.BVHModel]:
    """Return what takes half a second to build; it is read only, so that all may share it."""
    surface = ClosedSurface(vertices.array, triangles.array)
    mesh = fcl.BVHModel()
    mesh.beginModel(len(surface.triangles), len(surface.vertices))
    mesh.addSubModel(surface.vertices, surface.triangles)
    mesh.endModel()
    return surface, mesh


def _foot(start: Vector, end: Vector, point: np.ndarray) -> Vector:
    """Return the point of the segment from `start` to `end` that is nearest to `point`."""
    (ax, ay, az), (bx, by, bz), (px, py, pz) = start, end, point.tolist()
    ux, uy, uz = bx - ax, by - ay, bz - az
    size = ux * ux + uy * uy + uz * uz
    share = ((px - ax) * ux + (py - ay) * uy + (pz - az) * uz) / size if size > 0.0 else 0.0
    share = min(max(share, 0.0), 1.0)
    return (ax + share * ux, ay + share * uy, az + share * uz)
