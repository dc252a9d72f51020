"""The head's surface as triangles: its file, nearest points, outward normals and visibility.

The file is a PLY in mm; ours are binary, in RAS.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.ply import read_ply, write_ply
from rastrainer.head.triangle_tree import TriangleSides, TriangleTree

MAX_TRIANGLES = 1_000_000
RAS_LIMIT_MM = 2000.0
"""Limit of coordinates; scanners may have a distant origin."""


BASE_THICKNESS_MM = 1.0
FLAT_MM = 1e-3


@dataclass(frozen=True, eq=False)
class HeadMesh:
    """Vertices (n, 3) float, RAS mm; triangles (m, 3) int, counterclockwise seen from outside."""

    vertices: np.ndarray
    triangles: np.ndarray

    @property
    def sides(self) -> np.ndarray:
        """(3 m, 2) int: the sides of all triangles, from corner to next corner."""
        corners = self.triangles
        return np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])

    @cached_property
    def edges(self) -> np.ndarray:
        """(e, 2) int: every edge once, the lower vertex first."""
        edges = np.stack(np.divmod(np.unique(self._side_keys), len(self.vertices)), axis=1)
        return edges.astype(self.triangles.dtype)

    @property
    def side_uses(self) -> np.ndarray:
        """(m, 3) int: how many triangles share each side of each triangle."""
        _, places, uses = np.unique(self._side_keys, return_inverse=True, return_counts=True)
        return uses[places].reshape(3, -1).T

    @property
    def _side_keys(self) -> np.ndarray:
        """(3 m,) int: each side as one number, which sorts many times faster than a row."""
        low, high = np.sort(self.sides, axis=1).T.astype(np.int64)
        return low * len(self.vertices) + high

    @cached_property
    def base(self) -> np.ndarray:
        """(3,) float: the center of the flat base of the head, RAS mm."""
        heights = self.vertices[:, 2]
        base = self.vertices[heights <= heights.min() + BASE_THICKNESS_MM]
        return (base.min(axis=0) + base.max(axis=0)) / 2.0

    @cached_property
    def middle(self) -> np.ndarray:
        """(3,) float: the center of the box around the head, RAS mm."""
        return (self.vertices.min(axis=0) + self.vertices.max(axis=0)) / 2.0

    @cached_property
    def size(self) -> np.ndarray:
        """(3,) float: of the box around the head, mm."""
        return np.asarray(np.ptp(self.vertices, axis=0))

    @property
    def euler_characteristic(self) -> int:
        """Vertices − edges + triangles: 2 for one closed body without a tunnel."""
        return len(np.unique(self.triangles)) - len(self.edges) + len(self.triangles)

    @cached_property
    def is_closed(self) -> bool:
        """Whether every edge lies between exactly two triangles that run along it oppositely."""
        start, end = self.sides.T.astype(np.int64)
        keys, opposite = start * len(self.vertices) + end, end * len(self.vertices) + start
        keys.sort()
        opposite.sort()
        return bool(np.all(keys[1:] != keys[:-1]) and np.array_equal(keys, opposite))

    @cached_property
    def vertex_normals(self) -> np.ndarray:
        """(n, 3) float: outward unit normals, means of the triangles' weighted by their areas."""
        weighted = np.tile(self._crosses, (3, 1))
        corners, count = self.triangles.T.ravel(), len(self.vertices)
        # Faster than `np.add.at`, which sums in the same order.
        normals = np.stack([np.bincount(corners, along, count) for along in weighted.T], axis=1)
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        return normals / np.where(lengths > 0, lengths, 1.0)

    @cached_property
    def triangle_normals(self) -> np.ndarray:
        """(m, 3) float: outward unit normals; zero where a triangle has no area."""
        normals = self._crosses
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        return np.asarray(normals / np.where(lengths > 0, lengths, 1.0))

    @property
    def _crosses(self) -> np.ndarray:
        """(m, 3) float: outward normals as long as twice the triangles' areas."""
        a, b, c = self.corners()
        return np.cross(b - a, c - a)

    def corners(self) -> Iterator[np.ndarray]:
        """Return the first, the second and the third corners of all triangles, each (m, 3)."""
        return (self.vertices[self.triangles[:, corner]] for corner in range(3))

    @cached_property
    def triangle_spheres(self) -> tuple[np.ndarray, np.ndarray]:
        """Centers (m, 3) and radii (m,) of spheres that hold the triangles, mm."""
        a, b, c = self.corners()
        centers = (a + b + c) / 3.0
        away = [np.linalg.norm(corner - centers, axis=1) for corner in (a, b, c)]
        return centers, np.maximum.reduce(away)

    @cached_property
    def skin(self) -> HeadMesh:
        """The surface without the flat base, where the head is cut: nothing touches it there."""
        heights = self.vertices[:, 2][self.triangles]
        return HeadMesh(
            self.vertices, self.triangles[(heights > heights.min() + FLAT_MM).any(axis=1)]
        )

    @cached_property
    def tree(self) -> TriangleTree:
        """The search for the nearest points of many points; takes about a tenth of a second."""
        return TriangleTree(self.vertices[self.triangles])

    @property
    def centroid(self) -> np.ndarray:
        """(3,) float: the center of mass of the closed body, RAS mm."""
        a, b, c = self.corners()
        volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
        return volumes @ (a + b + c) / (4.0 * volumes.sum())


def write_head_mesh(path: Path, mesh: HeadMesh) -> None:
    write_ply(path, mesh.vertices, "RAS", mesh.triangles)


def read_head_mesh(path: Path) -> HeadMesh:
    """Read a mesh from a PLY file that says that it is in RAS or LPS; faces become triangles."""
    path = Path(path)
    if not path.is_file():
        raise InputError(f"The mesh {path} does not exist.")
    content = read_ply(path)
    if content.space not in ("RAS", "LPS"):
        raise InputError(
            f"The mesh {path} must say whether it is in RAS or LPS: add the line "
            '"comment SPACE=RAS" or "comment SPACE=LPS" to its header.'
        )
    faces = content.elements.get("face", {})
    try:
        vertices = content.vertices
        polygons = faces["vertex_indices"] if "vertex_indices" in faces else faces["vertex_index"]
        corners = polygons.size if isinstance(polygons, np.ndarray) else sum(map(len, polygons))
    except (LookupError, ValueError, TypeError):
        raise InputError(
            f"The mesh {path} must have vertices x, y and z and faces with vertex_indices."
        ) from None
    if not 4 <= corners - 2 * len(polygons) <= MAX_TRIANGLES or len(vertices) < 4:
        raise InputError(f"The mesh {path} must have 4 to {MAX_TRIANGLES} triangles.")
    if not np.all(np.abs(vertices) <= RAS_LIMIT_MM):
        raise InputError(f"The mesh {path} has a vertex that is not within ±{RAS_LIMIT_MM:g} mm.")
    triangles = _triangles(polygons)
    if triangles is None or triangles.min() < 0 or triangles.max() >= len(vertices):
        raise InputError(f"The mesh {path} has a face that is not a polygon of its vertices.")
    return HeadMesh(vertices, triangles.astype(np.int32))


def _triangles(polygons: np.ndarray | list[np.ndarray]) -> np.ndarray | None:
    """Return polygons as triangles, (n, 3) int, which fan out from each one's first corner.

    None if one has fewer than three corners.
    """
    if isinstance(polygons, np.ndarray):
        alike = [polygons]
    else:
        by_size: dict[int, list[np.ndarray]] = {}
        for polygon in polygons:
            by_size.setdefault(len(polygon), []).append(polygon)
        alike = [np.array(same) for same in by_size.values()]
    if min(same.shape[1] for same in alike) < 3:
        return None
    fans = [same[:, [0, i, i + 1]] for same in alike for i in range(1, same.shape[1] - 1)]
    triangles = np.concatenate(fans)
    return triangles if triangles.dtype.kind in "iu" else None


POINTS_AT_ONCE = 8
"""Their distances to all vertices fit into a processor's cache; numpy's library for matrices would
begin threads for many more, which take longer to start than this takes."""


@dataclass(frozen=True)
class NearestPoint:
    """The point (3,) of a surface nearest to a given one, and its distance, mm.

    Its weights (3,) are barycentric coordinates in the triangle of this index.
    """

    position: np.ndarray
    distance: float
    triangle: int
    weights: np.ndarray


def nearest_on_mesh(mesh: HeadMesh, point: np.ndarray) -> NearestPoint:
    """Return the point of the surface nearest to `point` (3,)."""
    centers, radii = mesh.triangle_spheres
    to_centers = np.linalg.norm(centers - point, axis=1)
    near = np.flatnonzero(to_centers - radii <= (to_centers + radii).min())
    sides = TriangleSides.of(mesh.vertices[mesh.triangles[near]].astype(float))
    _, v, w = sides.nearest(np.asarray(point, dtype=float))
    positions = sides.at(v, w)
    distances = np.linalg.norm(positions - point, axis=1)
    best = int(np.argmin(distances))
    weights = np.array([1.0 - v[best] - w[best], v[best], w[best]])
    return NearestPoint(positions[best], float(distances[best]), int(near[best]), weights)


def nearest_vertices(mesh: HeadMesh, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return how far the nearest vertex is from each point, (n,) float, mm, and its index."""
    indices = np.empty(len(points), dtype=int)
    squares = np.einsum("ij,ij->i", mesh.vertices, mesh.vertices)
    columns, doubled = np.ascontiguousarray(mesh.vertices.T), -2.0 * points
    compared = np.empty((POINTS_AT_ONCE, len(squares)))
    for start in range(0, len(points), POINTS_AT_ONCE):
        rows = doubled[start : start + POINTS_AT_ONCE]
        # |v|² − 2 v·p: as |v − p|², without the term that all vertices share.
        some = np.matmul(rows, columns, out=compared[: len(rows)])
        some += squares
        indices[start : start + len(rows)] = some.argmin(axis=1)
    return np.linalg.norm(mesh.vertices[indices] - points, axis=1), indices


def normal_at(mesh: HeadMesh, nearest: NearestPoint) -> np.ndarray:
    """Return the outward unit normal (3,) at a place of the surface."""
    normal = nearest.weights @ mesh.vertex_normals[mesh.triangles[nearest.triangle]]
    return normal / np.linalg.norm(normal)


def outward_normals(mesh: HeadMesh, points: Sequence[np.ndarray] | np.ndarray) -> np.ndarray:
    """Return the outward unit normals (n, 3) where the surface is nearest to `points` (n, 3)."""
    return np.array([normal_at(mesh, nearest_on_mesh(mesh, point)) for point in points])


_EDGE = 1e-9
_SAME_MM = 1e-6


class MeshCrossing(NamedTuple):
    """Where a line goes through a surface: at a distance from its start, in mm, and whether in."""

    distance_mm: float
    is_entering: bool


def mesh_crossings(
    mesh: HeadMesh, start: np.ndarray, direction: np.ndarray, length_mm: float
) -> list[MeshCrossing]:
    """Return where a line goes through a closed surface, in order.

    The triangles are intersected as by Möller and Trumbore (1997). A line through an edge or a
    corner crosses once. Start (3,), mm, and direction (3,), a unit vector, are in the mesh's frame.
    """
    centers, radii = mesh.triangle_spheres
    to_center = centers - start
    along = to_center @ direction
    aside = np.einsum("ij,ij->i", to_center, to_center) - along**2
    near = np.flatnonzero(aside <= (radii + _SAME_MM) ** 2)
    corner, b, c = (mesh.vertices[mesh.triangles[near, k]] for k in range(3))
    ab, ac, to_start = b - corner, c - corner, start - corner
    across = np.cross(np.broadcast_to(direction, ac.shape), ac)
    area = np.einsum("ij,ij->i", ab, across)
    turned = np.cross(to_start, ab)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = np.einsum("ij,ij->i", to_start, across) / area
        v = turned @ direction / area
        distance = np.einsum("ij,ij->i", ac, turned) / area
        is_hit = (u >= -_EDGE) & (v >= -_EDGE) & (u + v <= 1.0 + _EDGE)
        is_hit &= (distance >= 0.0) & (distance <= length_mm)
    found: list[MeshCrossing] = []
    hits = np.flatnonzero(is_hit)
    for hit in hits[np.argsort(distance[hits], kind="stable")]:
        # A triangle turned against the line has a positive determinant.
        crossing = MeshCrossing(float(distance[hit]), bool(area[hit] > 0.0))
        if not found or crossing.distance_mm - found[-1].distance_mm > _SAME_MM:
            found.append(crossing)
    return found


def hides(mesh: HeadMesh, eye: np.ndarray, point: np.ndarray, slack_mm: float = 1.0) -> bool:
    """Return whether the surface is between `eye` and `point`, both (3,), but for `slack_mm`.

    The point is on the surface.
    """
    along = np.asarray(point - eye, dtype=float)
    length = float(np.linalg.norm(along))
    return bool(mesh_crossings(mesh, eye, along / length, length - slack_mm))
