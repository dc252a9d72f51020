"""Exact signed distances to the head, in the head's frame."""

from __future__ import annotations

import hashlib
import math
from typing import NamedTuple

import fcl
import numpy as np

from rastrainer.errors import InputError
from rastrainer_simulator.vectors import Vector, vector

# Shares of a triangle: below them a point lies on an edge or corner, and a triangle has no area.
_ON_FEATURE = 1e-6
_FLAT = 1e-12


class Nearest(NamedTuple):
    """The point (m) of the head's surface that is nearest to the tip or to the shaft.

    The distance is below zero inside the head; it grows along the normal, a unit vector.
    """

    distance_m: float
    point: Vector
    normal: Vector
    triangle: int


class ClosedSurface:
    """Vertices, triangles turned outward, and a pseudonormal for every face, edge and vertex.

    The distance to the nearest surface point has the sign of the scalar product with the
    pseudonormal of its feature (face, edge or vertex): a face's normal, the sum of an edge's two
    face normals, or a vertex's face normals weighted by their angles (Bærentzen and Aanæs 2005,
    10.1109/TVCG.2005.49, theorem 1).
    """

    def __init__(self, vertices: np.ndarray, triangles: np.ndarray) -> None:
        """Take (n, 3) float vertices and (m, 3) int triangles; equal vertices become one."""
        vertices, index = np.unique(vertices, axis=0, return_inverse=True)
        triangles = index.reshape(-1)[triangles]
        a, b, c = triangles.T
        triangles = triangles[(a != b) & (b != c) & (c != a)]
        neighbors = _neighbors(triangles, len(vertices))
        a, b, c = vertices[triangles].swapaxes(0, 1)
        if np.einsum("ij,ij->", a, np.cross(b, c)) < 0.0:
            triangles, neighbors = triangles[:, ::-1], neighbors[:, [1, 0, 2]]
        corners = vertices[triangles]
        u = np.roll(corners, -1, axis=1) - corners
        faces = np.cross(u[:, 0], u[:, 1])
        sizes = np.linalg.norm(faces, axis=1)
        # A triangle without area takes the normals of its neighbors.
        flat = sizes <= _FLAT * np.square(u).sum(axis=(1, 2))
        faces /= np.where(flat, 1.0, sizes)[:, None]
        faces[flat] = 0.0
        faces[flat] = faces[neighbors[flat]].sum(axis=1)
        v = np.roll(corners, 1, axis=1) - corners
        sines = np.linalg.norm(np.cross(u, v), axis=2)
        angles = np.arctan2(sines, np.einsum("ijk,ijk->ij", u, v))
        around = [
            np.bincount(triangles.ravel(), (faces[:, None, k] * angles).ravel(), len(vertices))
            for k in range(3)
        ]
        self.vertices, self.triangles = vertices, triangles
        self._neighbors, self._face_normals = neighbors, faces
        self._vertex_normals = np.stack(around, axis=1)

    def pseudonormal(self, triangle: int, point: np.ndarray) -> list[float]:
        """Return the outward direction (3 floats, not of unit length) at a point of a triangle."""
        corners = self.triangles[triangle]
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = self.vertices[corners].tolist()
        px, py, pz = point.tolist()
        ux, uy, uz = bx - ax, by - ay, bz - az
        vx, vy, vz = cx - ax, cy - ay, cz - az
        wx, wy, wz = px - ax, py - ay, pz - az
        uu, uv, vv = (
            ux * ux + uy * uy + uz * uz,
            ux * vx + uy * vy + uz * vz,
            vx * vx + vy * vy + vz * vz,
        )
        wu, wv = wx * ux + wy * uy + wz * uz, wx * vx + wy * vy + wz * vz
        area = uu * vv - uv * uv
        small = _ON_FEATURE * area
        at_1, at_2 = vv * wu - uv * wv, uu * wv - uv * wu
        at_0 = area - at_1 - at_2
        # The face is 0, its edges 01, 12 and 20 are 1 to 3, its vertices 4 to 6.
        if at_2 < small:
            feature = 5 if at_0 < small else 4 if at_1 < small else 1
        elif at_0 < small:
            feature = 6 if at_1 < small else 2
        else:
            feature = 3 if at_1 < small else 0
        if feature > 3:
            return self._vertex_normals[corners[feature - 4]].tolist()
        face = self._face_normals[triangle]
        if feature == 0:
            return face.tolist()
        return (face + self._face_normals[self._neighbors[triangle, feature - 1]]).tolist()

    def crossing(self, triangle: int, start: Vector, end: Vector) -> tuple[Vector, Vector]:
        """Return where a segment goes through a triangle, and the outward normal there."""
        normal = self._face_normals[triangle]
        corner = self.vertices[self.triangles[triangle, 0]]
        before, behind = (float(normal @ (np.array(point) - corner)) for point in (start, end))
        share = before / (before - behind) if before != behind else 0.0
        point = vector(a + share * (b - a) for a, b in zip(start, end, strict=True))
        return point, vector(normal.tolist())


def _neighbors(triangles: np.ndarray, vertex_count: int) -> np.ndarray:
    """Return for each triangle (m, 3) the triangles across its edges 01, 12 and 20."""
    start = triangles.ravel()
    end = np.roll(triangles, -1, axis=1).ravel()
    there, back = start * vertex_count + end, end * vertex_count + start
    order = np.argsort(there)
    found = np.searchsorted(there, back, sorter=order).clip(max=len(there) - 1)
    twins = order[found]
    open_edges = int((there[twins] != back).sum())
    if open_edges or (np.diff(there[order]) == 0).any():
        raise InputError(
            "The head's surface should be closed, each edge between two triangles that are turned "
            f"the same way; {open_edges or 'some'} edges are not."
        )
    return (twins // 3).reshape(-1, 3)


_REQUEST = fcl.DistanceRequest(enable_nearest_points=True)
_ALL = fcl.CollisionRequest(num_max_contacts=10**6)
# Nearer than this, the line to the nearest point has no reliable direction.
_TOUCHING = 1e-9
_BASE_THICKNESS = 0.001


def thin_segment(start: np.ndarray, end: np.ndarray) -> fcl.CollisionObject:
    """Return the segment between two points (3,) float of the frame whose pose is set later."""
    return fcl.CollisionObject(_segments(start[None], end))


def _segments(starts: np.ndarray, end: np.ndarray) -> fcl.BVHModel:
    """Return the segments between points (n, 3) and one point (3,), as triangles without area."""
    count, ends = len(starts), np.broadcast_to(end, starts.shape)
    corners = np.stack([starts, ends, (starts + ends) / 2.0], axis=1).reshape(-1, 3)
    mesh = fcl.BVHModel()
    mesh.beginModel(count, 3 * count)
    mesh.addSubModel(corners, np.arange(3 * count).reshape(-1, 3))
    mesh.endModel()
    return mesh


class HeadSurface:
    """The head as a bounding volume hierarchy of its triangles, and as a closed surface.

    fcl gives the exact distance without sign; the pseudonormal at the nearest point gives the sign.
    All lengths in m, all points in the head's frame.
    """

    def __init__(self, vertices: np.ndarray, triangles: np.ndarray) -> None:
        """Take (n, 3) float vertices and (m, 3) int triangles; the last surface is cached."""
        self._surface, mesh = _shapes(
            np.asarray(vertices, dtype=float), np.asarray(triangles, dtype=np.int64)
        )
        vertices = self._surface.vertices
        base = vertices[vertices[:, 2] <= vertices[:, 2].min() + _BASE_THICKNESS]
        self.base = (base.min(axis=0) + base.max(axis=0)) / 2.0
        """(3,) float: the middle of the lowest millimeter, on which the head is."""
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
        result = fcl.DistanceResult()
        distance = fcl.distance(self._head, self._point, _REQUEST, result)
        # fcl sets no nearest points where shapes meet.
        on_head = position if distance <= 0.0 else result.nearest_points[0]
        return self._signed(point, distance, on_head, result.b1)

    def nearest_to_segment(
        self, segment: fcl.CollisionObject, start: Vector, end: Vector, radius: float
    ) -> Nearest:
        """Return the place of the surface nearest to a capsule.

        `segment` is its axis from `start` to `end`, its pose already set. Where the axis itself
        goes through the surface, the distance is −radius: at least so deep is the capsule.
        """
        result = fcl.DistanceResult()
        distance = fcl.distance(self._head, segment, _REQUEST, result)
        on_head, triangle = result.nearest_points[0], result.b1
        if distance <= 0.0:
            point, normal = self._surface.crossing(triangle, start, end)
            return Nearest(-radius, point, normal, triangle)
        (ax, ay, az), (bx, by, bz), (px, py, pz) = start, end, on_head.tolist()
        ux, uy, uz = bx - ax, by - ay, bz - az
        size = ux * ux + uy * uy + uz * uz
        share = ((px - ax) * ux + (py - ay) * uy + (pz - az) * uz) / size if size > 0.0 else 0.0
        share = min(max(share, 0.0), 1.0)
        return self._signed(
            (ax + share * ux, ay + share * uy, az + share * uz), distance, on_head, triangle, radius
        )

    def are_crossed(self, starts: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Return which segments between points (n, 3) and one point (3,) cross it, (n,) bool."""
        result, count = fcl.CollisionResult(), len(starts)
        if count:
            fcl.collide(self._head, fcl.CollisionObject(_segments(starts, end)), _ALL, result)
        crossed = np.zeros(count, dtype=bool)
        crossed[[contact.b2 for contact in result.contacts]] = True
        return crossed

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


_last: dict[bytes, tuple[ClosedSurface, fcl.BVHModel]] = {}


def _shapes(vertices: np.ndarray, triangles: np.ndarray) -> tuple[ClosedSurface, fcl.BVHModel]:
    """Return what takes half a second to build; it is read only, so that all may share it."""
    key = hashlib.sha256(vertices.tobytes() + triangles.tobytes()).digest()
    found = _last.get(key)
    if found is None:
        surface = ClosedSurface(vertices, triangles)
        mesh = fcl.BVHModel()
        mesh.beginModel(len(surface.triangles), len(surface.vertices))
        mesh.addSubModel(surface.vertices, surface.triangles)
        mesh.endModel()
        found = surface, mesh
        _last.clear()
        _last[key] = found
    return found
