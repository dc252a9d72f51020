"""Nearest points on many triangles for many points at once: a tree of boxes, on numpy alone.

The triangles are halved along the longest side of their box again and again; a search goes down the
levels for all points together and drops every box that is farther away than what is already known.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.head.triangle_sides import TriangleSides, least_of_each

LEAF = 8
"""Triangles in a box of the lowest level."""
TOP_LEVEL = 5
REPRESENTED_LEVEL = 7
"""Boxes of this level are distinguished by the middle of one lowest box within each."""


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

    Attributes:
        sides: The triangles, in the tree's order; the last is there several times.
    """

    def __init__(self, corners: np.ndarray) -> None:
        levels = max(int(np.ceil(np.log2(max(len(corners) / LEAF, 1.0)))), 0)
        self._order = _halved(corners.mean(axis=1), levels)
        ordered = np.asarray(corners, dtype=float)[self._order]
        self.sides = TriangleSides.of(ordered)
        lows, highs = ordered.min(axis=1), ordered.max(axis=1)
        self._triangle_boxes = np.hstack([lows, highs])
        lows = lows.reshape(-1, LEAF, 3).min(axis=1)
        highs = highs.reshape(-1, LEAF, 3).max(axis=1)
        self._middles = (lows + highs) / 2.0
        self._boxes = [np.hstack([lows, highs])]
        for _ in range(levels):
            lows = lows.reshape(-1, 2, 3).min(axis=1)
            highs = highs.reshape(-1, 2, 3).max(axis=1)
            self._boxes.insert(0, np.hstack([lows, highs]))

    def nearest(self, points: np.ndarray) -> NearestPoints:
        """Return the nearest point of the surface for each point (n, 3), finite, mm."""
        points = np.asarray(points, dtype=float)
        # A box as far away as what is known may hold it.
        who, triangle = self.nearby(points, self.reach(points) * (1.0 + 1e-9) + 1e-12)
        squares, v, w = self.sides.taken(triangle).nearest(points[who])
        best = least_of_each(squares, np.searchsorted(who, np.arange(len(points))), who)
        return self.found(points, triangle[best], v[best], w[best])

    def found(
        self, points: np.ndarray, places: np.ndarray, v: np.ndarray, w: np.ndarray
    ) -> NearestPoints:
        """Return nearest points by the places (n,) int of their triangles in `sides`, v and w."""
        positions = self.sides.taken(places).at(v, w)
        distances = np.linalg.norm(positions - points, axis=1)
        return NearestPoints(positions, distances, self._order[places])

    def nearby(self, points: np.ndarray, squares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return pairs of point and triangle, sorted by point: all within a squared distance.

        Args:
            points: (n, 3) float, mm.
            squares: (n,) float, mm², at least that to the nearest triangle.

        Returns:
            The points (p,) int, and the places (p,) int of the triangles in `sides`; some pairs
            are farther apart, none that are near is missing.
        """
        who, leaf = self._leaves_within(points, squares)
        who = np.repeat(who, LEAF)
        triangle = (leaf[:, None] * LEAF + np.arange(LEAF)).ravel()
        boxes = self._triangle_boxes.take(triangle, axis=0)
        kept = _is_within(boxes, points[who], squares[who])
        return who[kept], triangle[kept]

    def reach(self, points: np.ndarray) -> np.ndarray:
        """Return squared distances (n,), mm², to a triangle that is near in most cases."""
        level = min(REPRESENTED_LEVEL, len(self._boxes) - 1)
        middles = self._middles.reshape(2**level, -1, 3)
        entry = middles[:, middles.shape[1] // 2]
        # |m|² − 2 m·p: as |m − p|², without what all boxes share.
        box = (np.sum(entry**2, axis=1) - 2.0 * points @ entry.T).argmin(axis=1)
        own = middles[box]
        away = np.einsum("nki,nki->nk", own, own) - 2.0 * np.einsum("nki,ni->nk", own, points)
        box = box * middles.shape[1] + away.argmin(axis=1)
        tried = (box[:, None] * LEAF + np.arange(LEAF)).ravel()
        squares, _, _ = self.sides.taken(tried).nearest(np.repeat(points, LEAF, axis=0))
        return np.asarray(squares.reshape(-1, LEAF).min(axis=1))

    def _leaves_within(
        self, points: np.ndarray, squares: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return pairs of point and lowest box within its squared distance, sorted by point."""
        last = len(self._boxes) - 1
        level = min(TOP_LEVEL, last)
        near = _is_within(self._boxes[level][None], points[:, None], squares[:, None])
        who, box = np.nonzero(near)
        while level < last:
            level += 1
            who = np.repeat(who, 2)
            box = (box[:, None] * 2 + np.arange(2)).ravel()
            kept = _is_within(self._boxes[level].take(box, axis=0), points[who], squares[who])
            who, box = who[kept], box[kept]
        return who, box


def _is_within(boxes: np.ndarray, points: np.ndarray, squares: np.ndarray) -> np.ndarray:
    """Return which boxes (…, 6) of lowest and highest corner are within √squares (…) of points."""
    # Axis by axis, which takes a third of the time of rows of three.
    away: np.ndarray | float = 0.0
    for axis in range(3):
        place = points[..., axis]
        outside = np.maximum(boxes[..., axis] - place, place - boxes[..., 3 + axis])
        np.maximum(outside, 0.0, out=outside)
        away = away + outside * outside
    return np.asarray(away <= squares)


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
