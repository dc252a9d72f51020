"""Line segments, and capsules fitted about a solid: one, or one for each half of a long solid."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import fcl
import numpy as np

from rastrainer.errors import InputError


def segment_distance(
    a: Sequence[float], b: Sequence[float], c: Sequence[float], d: Sequence[float]
) -> float:
    """Return the distance of the segments a–b and c–d, each end three floats.

    The nearest points of the two lines, clamped to one segment after the other
    (Ericson, Real-Time Collision Detection, 2005, section 5.1.9).
    """
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = d[0] - c[0], d[1] - c[1], d[2] - c[2]
    wx, wy, wz = a[0] - c[0], a[1] - c[1], a[2] - c[2]
    uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    uv = ux * vx + uy * vy + uz * vz
    uw, vw = ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
    area = uu * vv - uv * uv
    # Parallel segments have many nearest pairs; starting from `a` finds one of them.
    s = min(max((uv * vw - vv * uw) / area, 0.0), 1.0) if area > 1e-12 * uu * vv else 0.0
    t = (uv * s + vw) / vv if vv > 0.0 else 0.0
    if not 0.0 <= t <= 1.0 or vv == 0.0:
        t = min(max(t, 0.0), 1.0)
        s = min(max((uv * t - uw) / uu, 0.0), 1.0) if uu > 0.0 else 0.0
    return math.dist(
        (a[0] + s * ux, a[1] + s * uy, a[2] + s * uz), (c[0] + t * vx, c[1] + t * vy, c[2] + t * vz)
    )


def thin_segment(start: np.ndarray, end: np.ndarray) -> fcl.CollisionObject:
    """Return the segment between two points (3,) float of the frame whose pose is set later."""
    mesh = fcl.BVHModel()
    mesh.beginModel(1, 3)
    mesh.addSubModel([start, end, (start + end) / 2.0], [[0, 1, 2]])
    mesh.endModel()
    return fcl.CollisionObject(mesh)


_LONG = 1.35  # A solid longer than this times its width gets a capsule for each half.
_FIRST_STEP, _LAST_STEP = 0.02, 0.0003
_MAX_POINTS = 5_000_000


@dataclass(frozen=True)
class Capsule:
    """All points within `radius` (m) of the segment from `start` to `end`, (3,) float each, m."""

    start: np.ndarray
    end: np.ndarray
    radius: float


def surface_points(vertices: np.ndarray, triangles: np.ndarray, spacing: float) -> np.ndarray:
    """Return points (k, 3) along the edges of a mesh, no two neighbors farther than `spacing`.

    `vertices` is (n, 3) float, `triangles` (m, 3) int.

    Raises:
        InputError: the mesh is so large, or has so many edges, that these are too many points.
    """
    edges = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    )
    start, end = vertices[np.unique(edges, axis=0).T]
    counts = np.ceil(np.linalg.norm(end - start, axis=1) / spacing).astype(int) + 1
    if counts.sum() > _MAX_POINTS:
        raise InputError(
            f"A collision mesh has {len(start)} edges of {counts.sum() * spacing:.0f} m in all; "
            "it should be a coarse hull of its link."
        )
    rows = np.repeat(np.arange(len(start)), counts)
    steps = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
    shares = steps / np.maximum(counts[rows] - 1, 1)
    return start[rows] + shares[:, None] * (end[rows] - start[rows])


def covering_capsules(points: np.ndarray, spacing: float) -> tuple[Capsule, ...]:
    """Return one capsule, or two for a long solid, that hold all `points` (k, 3) float, m.

    `points` are `surface_points` of that `spacing`: then the whole solid's surface is covered.
    """
    middle = points.mean(axis=0)
    axes = np.linalg.eigh(np.cov((points - middle).T)).eigenvectors
    along = (points - middle) @ axes
    length, width = np.ptp(along[:, 2]), np.ptp(along[:, 1])
    if length <= _LONG * width:
        return (_fit(points, axes.T),)
    cut = along[:, 2].min() + length / 2.0
    # Both halves reach over the cut, so that a triangle across it is completely inside them.
    halves = (along[:, 2] <= cut + spacing, along[:, 2] >= cut - spacing)
    return tuple(_fit(points[half], axes.T) for half in halves)


def _fit(points: np.ndarray, directions: np.ndarray) -> Capsule:
    """Return a capsule of little volume about the points, found by pattern search.

    The search starts along each of the `directions` (3, 3) and moves the ends of the axis.
    """
    outermost = points[np.unique((points @ sphere_directions().T).argmax(axis=0))]
    found = []
    for direction in directions:
        along = outermost @ direction
        center = (outermost.min(axis=0) + outermost.max(axis=0)) / 2.0
        reach = direction * np.ptp(along) / 5.0
        ends = np.concatenate([center - reach, center + reach])
        found.append(_pattern_search(outermost, ends))
    _, best = min(found, key=lambda each: each[0])
    start, end = best[:3], best[3:]
    return Capsule(start, end, _radius(points, start, end))


def _pattern_search(points: np.ndarray, ends: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the volume and the ends (6,) of the smallest capsule that small moves lead to."""
    volume, step = float(_volumes(points, ends[None])[0]), _FIRST_STEP
    moves = np.concatenate([np.eye(6), -np.eye(6)])
    while step > _LAST_STEP:
        trials = ends + step * moves
        volumes = _volumes(points, trials)
        best = int(volumes.argmin())
        if volumes[best] < volume:
            volume, ends = float(volumes[best]), trials[best]
        else:
            step /= 2.0
    return volume, ends


def _volumes(points: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return the volumes of the capsules with the axes `ends` (t, 6) that hold all points."""
    start, axis = ends[:, :3], ends[:, 3:] - ends[:, :3]
    sizes = np.einsum("ti,ti->t", axis, axis)
    offsets = points - start[:, None]
    shares = np.einsum("tki,ti->tk", offsets, axis) / np.maximum(sizes, 1e-12)[:, None]
    offsets -= shares.clip(0.0, 1.0)[:, :, None] * axis[:, None]
    squares = np.einsum("tki,tki->tk", offsets, offsets).max(axis=1)
    return math.pi * squares * (np.sqrt(sizes) + 4.0 / 3.0 * np.sqrt(squares))


def _radius(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> float:
    """Return the distance of the farthest point from a segment."""
    axis = end - start
    shares = ((points - start) @ axis / max(axis @ axis, 1e-12)).clip(0.0, 1.0)
    return float(np.linalg.norm(points - start - shares[:, None] * axis, axis=1).max())


def sphere_directions(count: int = 200) -> np.ndarray:
    """Return `count` unit vectors spread evenly over the sphere (a Fibonacci spiral)."""
    index = np.arange(count) + 0.5
    z = 1.0 - 2.0 * index / count
    turn = math.pi * (1.0 + math.sqrt(5.0)) * index
    width = np.sqrt(1.0 - z * z)
    return np.column_stack([width * np.cos(turn), width * np.sin(turn), z])
