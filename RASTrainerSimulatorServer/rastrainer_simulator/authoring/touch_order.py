"""The order in which fiducials are touched, and how demanding it is: one index of difficulty.

index = L / 100 mm + T / 90° + H + R / 90°

L is the length in mm of the path over the surface from the first to the last fiducial; T the total
turning of the path at the fiducials between, in degrees; H the number of fiducials hidden in the
default (close-up) view; R the total rotation of the tool to stay normal to the skin, in degrees.

Each unit is about one more action: a hand's width of travel, one corner, one change of the view,
one quarter turn of the tool. The weights of 1 are a convention, not a measured effort.

Shortest paths are searched in a graph of the mesh's vertices. It has the edges and, for every edge,
the straight path between the opposite corners of its two triangles, unfolded into one plane.
Lengths are never shorter than the geodesic and, on a sphere, about 2.5 % longer on average.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from rastrainer.head.mesh import HeadMesh, NearestPoint, hides, nearest_on_mesh, outward_normals

LENGTH_UNIT_MM = 100.0
ANGLE_UNIT_DEG = 90.0

GRAZING_DEG = 75.0
"""A fiducial at a larger angle between normal and eye is unreadable."""


@dataclass(frozen=True)
class Complexity:
    """The four parts of the index: L, T, H and R."""

    path_length_mm: float
    turning_deg: float
    hidden_points: int
    reorientation_deg: float

    @property
    def index(self) -> float:
        """The complexity index, without unit."""
        return (
            self.path_length_mm / LENGTH_UNIT_MM
            + self.turning_deg / ANGLE_UNIT_DEG
            + self.hidden_points
            + self.reorientation_deg / ANGLE_UNIT_DEG
        )


def complexity(fiducials: np.ndarray, graph: SurfaceGraph, eye: np.ndarray) -> Complexity:
    """Return the complexity of touching `fiducials` (n, 3) float, RAS mm, in order.

    `eye` is the position (3,) of the default view.
    """
    fiducials = np.asarray(fiducials, dtype=float)
    normals = outward_normals(graph.mesh, fiducials)
    return Complexity(
        path_length_mm=sum(itertools.starmap(graph.distance, itertools.pairwise(fiducials))),
        turning_deg=float(
            turns_deg(fiducials[:-2], fiducials[1:-1], fiducials[2:], normals[1:-1]).sum()
        ),
        hidden_points=sum(
            is_hidden(point, normal, graph.mesh, eye)
            for point, normal in zip(fiducials, normals, strict=True)
        ),
        reorientation_deg=float(_angles_deg(normals[:-1], normals[1:]).sum()),
    )


def turns_deg(
    before: np.ndarray, at: np.ndarray, after: np.ndarray, normals: np.ndarray
) -> np.ndarray:
    """Return the turning of paths at points, seen along the skin's normals there, degrees (n,).

    A path straight over curved skin does not turn. Shapes (n, 3).
    """
    return _angles_deg(
        *(
            along - normals * np.einsum("ij,ij->i", along, normals)[:, None]
            for along in (at - before, after - at)
        )
    )


def is_hidden(point: np.ndarray, normal: np.ndarray, mesh: HeadMesh, eye: np.ndarray) -> bool:
    """Return whether the number at `point` is hidden from `eye`; all (3,)."""
    angle = _angles_deg(normal[None], (eye - point)[None])[0]
    return bool(angle > GRAZING_DEG) or hides(mesh, eye, point)


def _angles_deg(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the angles (n,) between vectors (n, 3), degrees; 0 if one has no length."""
    across = np.linalg.norm(np.cross(a, b), axis=1)
    return np.degrees(np.arctan2(across, np.einsum("ij,ij->i", a, b)))


@dataclass(frozen=True)
class Transitions:
    """The costs of moving from fiducial to fiducial, in the units of the complexity index.

    Attributes:
        steps: (n, n) float: length over the skin and reorientation of the tool.
        turns: (n, n, n) float: turning at the second of three.
    """

    steps: np.ndarray
    turns: np.ndarray

    def costs(self, orders: ArrayLike) -> np.ndarray:
        """Return the costs (m,) of m orders of as many fiducials each, (m, count) int."""
        rows = np.asarray(orders)
        steps = self.steps[rows[:, :-1], rows[:, 1:]].sum(axis=1)
        return steps + self.turns[rows[:, :-2], rows[:, 1:-1], rows[:, 2:]].sum(axis=1)

    def easiest(self, orders: ArrayLike) -> tuple[float, list[int]]:
        """Return the least cost and the first order that has it."""
        rows = np.asarray(orders)
        costs = self.costs(rows)
        best = int(np.argmin(costs))
        return float(costs[best]), rows[best].tolist()


def transitions_between(
    points: np.ndarray, normals: np.ndarray, lengths_mm: np.ndarray
) -> Transitions:
    """Return the transitions between points; shapes (n, 3), (n, 3) and (n, n)."""
    count = len(points)
    first, second = np.indices((count, count)).reshape(2, -1)
    turned = _angles_deg(normals[first], normals[second]).reshape(count, count)
    before, at, after = np.indices((count,) * 3).reshape(3, -1)
    turns = turns_deg(points[before], points[at], points[after], normals[at])
    return Transitions(
        lengths_mm / LENGTH_UNIT_MM + turned / ANGLE_UNIT_DEG,
        turns.reshape((count,) * 3) / ANGLE_UNIT_DEG,
    )


def arc_lengths(points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Estimate the lengths of the paths over the skin between points (n, 3); (n, n) mm.

    The skin between two points is assumed to bend evenly, by the angle between their normals: good
    enough for ordering fiducials, and thousands of times faster than paths over the surface.
    """
    chords = np.linalg.norm(points[:, None] - points[None], axis=2)
    half = np.arccos(np.clip(normals @ normals.T, -1.0, 1.0)) / 2.0
    return chords / np.sinc(half / np.pi)


def easiest_order(transitions: Transitions, members: list[int]) -> list[int]:
    """Return the easiest order that is found from any start.

    The nearest fiducial comes next; then stretches are reversed and moved while that is cheaper.
    """
    orders = []
    for start in members:
        order, left = [start], set(members) - {start}
        while left:
            order.append(min(left, key=lambda other: (transitions.steps[order[-1], other], other)))
            left.remove(order[-1])
        best = np.inf
        while True:
            cost, cheapest = transitions.easiest(np.array(order)[_changes(len(order))])
            if cost >= best - 1e-9:
                break
            order, best = cheapest, cost
        orders.append(order)
    return transitions.easiest(orders)[1]


def crossing_order(transitions: Transitions, sides: list[list[int]], crossings: int) -> list[int]:
    """Return an order with a number of crossings between two sides.

    Each side is touched in its own easiest order, in runs of equal length.
    """
    first, second = (
        np.array_split(easiest_order(transitions, members), (crossings + 2 - side) // 2)
        for side, members in enumerate(sides)
    )
    orders = []
    for other in (second, [part[::-1] for part in second[::-1]]):
        runs = itertools.chain(*itertools.zip_longest(first, other, fillvalue=np.empty(0, int)))
        orders.append(np.concatenate(list(runs)))
    return transitions.easiest(orders)[1]


@cache
def _changes(count: int) -> np.ndarray:
    """Return every order (m, count) of places with one stretch reversed, or a short one moved."""
    order = list(range(count))
    changed = [order]
    for start in range(count):
        for end in range(start + 1, count + 1):
            stretch, rest = order[start:end], order[:start] + order[end:]
            changed.append(order[:start] + stretch[::-1] + order[end:])
            if len(stretch) <= 3:
                changed += [rest[:at] + stretch + rest[at:] for at in range(len(rest) + 1)]
    return np.array(changed)


class SurfaceGraph:
    """The paths over a mesh; distances in mm."""

    def __init__(self, mesh: HeadMesh) -> None:
        # Only here: a simulator that loads a scenario needs no paths, and need not wait for scipy.
        from scipy.sparse import csr_array

        self.mesh, count = mesh, len(mesh.vertices)
        across, across_mm = _paths_across(mesh)
        straight = np.linalg.norm(np.diff(mesh.vertices[mesh.edges], axis=1)[:, 0], axis=1)
        pairs = np.concatenate([mesh.edges, across])
        # Last come the paths from a point on a triangle to its corners: `distance` enters them.
        both = np.concatenate([pairs, pairs[:, ::-1], [(count, 0)] * 3])
        lengths = np.concatenate([straight, across_mm, straight, across_mm, np.zeros(3)])
        order = np.argsort(both[:, 0], kind="stable")
        rows = np.searchsorted(both[order, 0], np.arange(count + 2))
        # As rows: given pairs, scipy would add the lengths of paths between the same vertices.
        self._paths = csr_array((lengths[order], both[order, 1], rows), shape=(count + 1,) * 2)
        self._known: dict[tuple[float, ...], float] = {}

    def distance(self, start: np.ndarray, end: np.ndarray) -> float:
        """Return the length of the path over the surface between two points (3,) on it."""
        from scipy.sparse.csgraph import dijkstra

        # Complexity and shortest path of a task need the same paths.
        key = (*map(float, start), *map(float, end))
        if key not in self._known:
            first, last = nearest_on_mesh(self.mesh, start), nearest_on_mesh(self.mesh, end)
            straight = float(np.linalg.norm(first.position - last.position))
            if first.triangle == last.triangle:
                self._known[key] = straight
            else:
                far = self.mesh.triangles[last.triangle]
                self._paths.indices[-3:] = self.mesh.triangles[first.triangle]
                self._paths.data[-3:] = self._to(first)
                # Nearly all paths are shorter than twice the straight line.
                for limit in (2.0 * straight + 20.0, np.inf):
                    whole = dijkstra(self._paths, indices=-1, limit=limit)[far] + self._to(last)
                    if np.isfinite(whole).any():
                        break
                self._known[key] = float(whole.min())
        return self._known[key]

    def _to(self, point: NearestPoint) -> np.ndarray:
        """Return the distances (3,) to the corners of a point's triangle."""
        corners = self.mesh.vertices[self.mesh.triangles[point.triangle]]
        return np.asarray(np.linalg.norm(corners - point.position, axis=1))


def _paths_across(mesh: HeadMesh) -> tuple[np.ndarray, np.ndarray]:
    """Return the paths between opposite corners of neighboring triangles, where straight."""
    low, high = np.sort(mesh.sides, axis=1).T
    opposite = np.concatenate([mesh.triangles[:, corner] for corner in (2, 0, 1)])
    order = np.lexsort((high, low))
    low, high, opposite = low[order], high[order], opposite[order]
    pair = np.flatnonzero((low[1:] == low[:-1]) & (high[1:] == high[:-1]))
    a, b = mesh.vertices[low[pair]], mesh.vertices[high[pair]]
    ends = np.stack([opposite[pair], opposite[pair + 1]], axis=1)
    along = b - a
    width = np.linalg.norm(along, axis=1)
    # Place of each corner along the edge and its height above it, in its own triangle's plane.
    place, height = [], []
    for end in ends.T:
        offset = mesh.vertices[end] - a
        place.append(np.einsum("ij,ij->i", offset, along) / width)
        height.append(np.linalg.norm(np.cross(offset, along), axis=1) / width)
    total = np.maximum(height[0] + height[1], 1e-12)
    crossing = place[0] + (place[1] - place[0]) * height[0] / total
    straight = (crossing > 0) & (crossing < width)
    length = np.hypot(place[0] - place[1], total)
    return ends[straight], length[straight]


def shortest_path_mm(fiducials: np.ndarray, graph: SurfaceGraph) -> float:
    """Return the length in mm of the shortest free path through (n, 3) fiducials in order.

    It joins two fiducials by the straight line or, if the head is in the way, by the path along the
    skin, about 2.5 % too long in the graph. Takes about half a second.
    """
    fiducials = np.asarray(fiducials, dtype=float)
    normals = outward_normals(graph.mesh, fiducials)
    return sum(
        float(np.linalg.norm(fiducials[i + 1] - fiducials[i]))
        if _is_free(graph.mesh, fiducials[i : i + 2], normals[i : i + 2])
        else graph.distance(fiducials[i], fiducials[i + 1])
        for i, _ in enumerate(fiducials[1:])
    )


def _is_free(mesh: HeadMesh, ends: np.ndarray, normals: np.ndarray) -> bool:
    """Return whether the straight line leaves the skin outward at both ends and hits nothing."""
    along = ends[1] - ends[0]
    if along @ normals[0] <= 0 or -along @ normals[1] <= 0:
        return False
    # The line would meet the triangle that it starts on first.
    return not hides(mesh, ends[0] + along / np.linalg.norm(along), ends[1])
