"""Nearest points on many triangles for many points at once: a tree of boxes, on numpy alone.

The triangles are halved along the longest side of their box again and again; a search goes down the
levels for all points together and drops every box that is farther away than what is already known.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LEAF = 8
"""Triangles in a box of the lowest level."""
TOP_LEVEL = 5
POOR_GUESS_MM = 2.0
REPRESENTED_LEVEL = 9
"""Boxes of this level are told apart by the middle of one lowest box within each."""


@dataclass(frozen=True)
class NearestPoints:
    """The points of a surface nearest to n given ones; mm.

    Attributes:
        positions: (n, 3) float.
        distances: (n,) float, to the given points.
        triangles: (n,) int, indices of the triangles that they lie on.
    """

    positions: np.ndarray
    distances: np.ndarray
    triangles: np.ndarray


class TriangleTree:
    """The boxes of a mesh's triangles.

    Args:
        corners: (m, 3, 3) float, mm, the corners of at least one triangle.
    """

    def __init__(self, corners: np.ndarray) -> None:
        levels = max(int(np.ceil(np.log2(max(len(corners) / LEAF, 1.0)))), 0)
        self._order = _halved(corners.mean(axis=1), levels)
        self._place = np.empty(len(corners), dtype=np.int64)
        self._place[self._order] = np.arange(len(self._order))
        ordered = np.asarray(corners, dtype=float)[self._order]
        self._sides = _Sides.of(ordered)
        lows, highs = ordered.min(axis=1), ordered.max(axis=1)
        self._triangle_boxes = lows, highs
        lows = lows.reshape(-1, LEAF, 3).min(axis=1)
        highs = highs.reshape(-1, LEAF, 3).max(axis=1)
        self._middles = (lows + highs) / 2.0
        self._boxes = [(lows, highs)]
        for _ in range(levels):
            lows = lows.reshape(-1, 2, 3).min(axis=1)
            highs = highs.reshape(-1, 2, 3).max(axis=1)
            self._boxes.insert(0, (lows, highs))

    def nearest(self, points: np.ndarray, guess: np.ndarray | None = None) -> NearestPoints:
        """Return the nearest point of the surface for each point (n, 3).

        Args:
            points: (n, 3) float, finite, mm.
            guess: (n,) int, a triangle that is near each point, which saves time; the answer does
                not depend on it.
        """
        points = np.asarray(points, dtype=float)
        if guess is None:
            reach = self._reach(points)
        else:
            of, along = self._place[guess], np.arange(len(points))
            reach = self._sides.nearest(points, along, of)[0]
            poor = np.flatnonzero(reach > POOR_GUESS_MM**2)
            reach[poor] = np.minimum(reach[poor], self._reach(points[poor]))
        # A box as far away as what is known may hold it.
        reach = reach * (1.0 + 1e-9) + 1e-12
        who, leaf = self._leaves_within(points, reach)
        who = np.repeat(who, LEAF)
        triangle = (leaf[:, None] * LEAF + np.arange(LEAF)).ravel()
        kept = _is_within(self._triangle_boxes, triangle, points[who], reach[who])
        who, triangle = who[kept], triangle[kept]
        squares, v, w = self._sides.nearest(points, who, triangle)
        starts = np.searchsorted(who, np.arange(len(points)))
        least = np.minimum.reduceat(squares, starts)
        ties = np.flatnonzero(squares == least[who])
        best = ties[np.searchsorted(who[ties], np.arange(len(points)))]
        chosen = triangle[best]
        positions = self._sides.at(chosen, v[best], w[best])
        distances = np.linalg.norm(positions - points, axis=1)
        return NearestPoints(positions, distances, self._order[chosen])

    def _reach(self, points: np.ndarray) -> np.ndarray:
        """Return squared distances (n,) to a triangle that is near each point in most cases."""
        level = min(REPRESENTED_LEVEL, len(self._boxes) - 1)
        middles = self._middles.reshape(2**level, -1, 3)
        # |m|² − 2 m·p: as |m − p|², without what all boxes share.
        entry = middles[:, middles.shape[1] // 2]
        box = (np.sum(entry**2, axis=1) - 2.0 * points @ entry.T).argmin(axis=1)
        away = np.sum((middles[box] - points[:, None]) ** 2, axis=2)
        box = box * middles.shape[1] + away.argmin(axis=1)
        who = np.repeat(np.arange(len(points)), LEAF)
        squares, _, _ = self._sides.nearest(
            points, who, (box[:, None] * LEAF + np.arange(LEAF)).ravel()
        )
        return squares.reshape(-1, LEAF).min(axis=1)

    def _leaves_within(
        self, points: np.ndarray, squares: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return pairs of point and lowest box within its squared distance, sorted by point."""
        last = len(self._boxes) - 1
        level = min(TOP_LEVEL, last)
        count = len(self._boxes[level][0])
        who = np.repeat(np.arange(len(points)), count)
        box = np.tile(np.arange(count), len(points))
        while True:
            kept = _is_within(self._boxes[level], box, points[who], squares[who])
            who, box = who[kept], box[kept]
            if level == last:
                return who, box
            level += 1
            who = np.repeat(who, 2)
            box = (box[:, None] * 2 + np.arange(2)).ravel()


@dataclass(frozen=True)
class _Sides:
    """Triangles as a corner and two sides, with the products that the search needs."""

    corner: np.ndarray
    to_b: np.ndarray
    to_c: np.ndarray
    products: np.ndarray

    @classmethod
    def of(cls, corners: np.ndarray) -> _Sides:
        a = corners[:, 0]
        to_b, to_c = corners[:, 1] - a, corners[:, 2] - a
        bb, bc, cc = (
            np.einsum("ij,ij->i", one, other)
            for one, other in ((to_b, to_b), (to_b, to_c), (to_c, to_c))
        )
        return cls(a, to_b, to_c, np.stack([bb, bc, cc], axis=1))

    def at(self, rows: np.ndarray, v: np.ndarray, w: np.ndarray) -> np.ndarray:
        """Return the points corner + v·b + w·c of triangles, (n, 3)."""
        return self.corner[rows] + v[:, None] * self.to_b[rows] + w[:, None] * self.to_c[rows]

    def nearest(
        self, points: np.ndarray, who: np.ndarray, rows: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return squared distance, v and w, each (p,), of the nearest point for p pairs.

        The squared distance is a square in v and w: its minimum lies inside or on a side.
        """
        offset = points[who] - self.corner[rows]
        along_b = np.einsum("ij,ij->i", offset, self.to_b[rows])
        along_c = np.einsum("ij,ij->i", offset, self.to_c[rows])
        bb, bc, cc = self.products[rows].T
        determinant = bb * cc - bc * bc
        # Without area, there is no inside: the nearest point lies on a side.
        safe = np.where(determinant > 1e-12 * bb * cc, determinant, np.inf)
        v, w = (cc * along_b - bc * along_c) / safe, (bb * along_c - bc * along_b) / safe
        outside = np.flatnonzero((v < 0) | (w < 0) | (v + w > 1) | np.isinf(safe))
        gain = 2 * (v * along_b + w * along_c) - v * v * bb - 2 * v * w * bc - w * w * cc
        if len(outside):
            sides = (bb[outside], bc[outside], cc[outside])
            v[outside], w[outside], gain[outside] = _on_sides(
                along_b[outside], along_c[outside], *sides
            )
        squares = np.einsum("ij,ij->i", offset, offset) - gain
        return np.maximum(squares, 0.0), v, w


def _is_within(
    boxes: tuple[np.ndarray, np.ndarray], rows: np.ndarray, points: np.ndarray, squares: np.ndarray
) -> np.ndarray:
    """Return which boxes (p,) bool are within a squared distance (p,) of points (p, 3)."""
    lows, highs = boxes
    outside = np.maximum(lows[rows] - points, points - highs[rows])
    np.maximum(outside, 0.0, out=outside)
    return np.einsum("ij,ij->i", outside, outside) <= squares


def _on_sides(
    along_b: np.ndarray, along_c: np.ndarray, bb: np.ndarray, bc: np.ndarray, cc: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return v, w and how much nearer than the corner: the best of the three sides."""
    tiny = 1e-30
    on_b = np.clip(along_b / np.maximum(bb, tiny), 0.0, 1.0)
    on_c = np.clip(along_c / np.maximum(cc, tiny), 0.0, 1.0)
    opposite = np.maximum(bb - 2 * bc + cc, tiny)
    share = np.clip((along_c - along_b + bb - bc) / opposite, 0.0, 1.0)
    zero = np.zeros_like(on_b)
    v = np.stack([on_b, zero, 1.0 - share])
    w = np.stack([zero, on_c, share])
    gain = 2 * (v * along_b + w * along_c) - v * v * bb - 2 * v * w * bc - w * w * cc
    best = gain.argmax(axis=0)
    columns = np.arange(len(best))
    return v[best, columns], w[best, columns], gain[best, columns]


def _halved(centers: np.ndarray, levels: int) -> np.ndarray:
    """Return an order (LEAF · 2^levels,) whose halves, quarters … are compact; the last repeats."""
    order = np.arange(LEAF * 2**levels)
    order[len(centers) :] = len(centers) - 1
    for level in range(levels):
        rows = order.reshape(2**level, -1)
        places = centers[rows]
        axis = np.ptp(places, axis=1).argmax(axis=1)
        keys = np.take_along_axis(places, axis[:, None, None], axis=2)[:, :, 0]
        order = np.take_along_axis(rows, keys.argsort(axis=1, kind="stable"), axis=1).ravel()
    return order
