"""Nearest points on many triangles for many points at once: a tree of boxes, on numpy alone.

The triangles are halved along the longest side of their box again and again. A search goes down the
levels for all points together and drops every box farther away than a known triangle. (VTK's cell
locator takes one point at a time; a surface match with it takes 2 to 3 times as long.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_CORNER, _TO_B, _TO_C = slice(0, 3), slice(3, 6), slice(6, 9)
LEAF = 8
"""Triangles in a box of the lowest level."""
TOP_LEVEL = 5
REPRESENTED_LEVEL = 7
"""Boxes of this level are distinguished by the middle of one lowest box within each."""


@dataclass(frozen=True)
class TriangleSides:
    """Triangles with the products that a search for nearest points needs, mm.

    A row (12,) has the first corner, from it to the second (b) and to the third (c), and b·b, b·c
    and c·c: side by side, since picking rows is what takes the time.
    """

    rows: np.ndarray

    @classmethod
    def of(cls, corners: np.ndarray) -> TriangleSides:
        """Return the triangles with corners (m, 3, 3)."""
        a = corners[:, 0]
        to_b, to_c = corners[:, 1] - a, corners[:, 2] - a
        pairs = ((to_b, to_b), (to_b, to_c), (to_c, to_c))
        products = [np.einsum("ij,ij->i", one, other) for one, other in pairs]
        return cls(np.column_stack([a, to_b, to_c, *products]))

    def taken(self, rows: np.ndarray) -> TriangleSides:
        return TriangleSides(self.rows.take(rows, axis=0))

    def at(self, v: np.ndarray, w: np.ndarray) -> np.ndarray:
        """Return the points corner + v·b + w·c, (m, 3) float, for v and w, each (m,)."""
        rows = self.rows
        return rows[:, _CORNER] + v[:, None] * rows[:, _TO_B] + w[:, None] * rows[:, _TO_C]

    def nearest(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return squared distance, v and w, each (m,), from each point (m, 3) to its triangle.

        The squared distance is a square in v and w: its minimum lies inside or on a side.
        """
        offset = points - self.rows[:, _CORNER]
        along_b = np.einsum("ij,ij->i", offset, self.rows[:, _TO_B])
        along_c = np.einsum("ij,ij->i", offset, self.rows[:, _TO_C])
        bb, bc, cc = self.rows[:, 9:].T
        determinant = bb * cc - bc * bc
        # A triangle without area has its nearest point on a side.
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


def least_of_each(squares: np.ndarray, starts: np.ndarray, who: np.ndarray) -> np.ndarray:
    """Return the first pair of each point whose square is least, (n,) int.

    Pairs are sorted by point: `who` (p,) is the point of each, `starts` (n,) the first pair of
    each.
    """
    least = np.minimum.reduceat(squares, starts)
    ties = np.flatnonzero(squares == least[who])
    return np.asarray(ties[np.searchsorted(ties, starts)])


def _on_sides(
    along_b: np.ndarray, along_c: np.ndarray, bb: np.ndarray, bc: np.ndarray, cc: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return v, w and how much nearer than the corner: the best of the three sides."""
    tiny = 1e-30
    v = np.clip(along_b / np.maximum(bb, tiny), 0.0, 1.0)
    gain = v * (2.0 * along_b - v * bb)
    w = np.clip(along_c / np.maximum(cc, tiny), 0.0, 1.0)
    on_c = w * (2.0 * along_c - w * cc)
    better = on_c > gain
    v, w, gain = np.where(better, 0.0, v), np.where(better, w, 0.0), np.where(better, on_c, gain)
    share = (along_c - along_b + bb - bc) / np.maximum(bb - 2.0 * bc + cc, tiny)
    share = np.clip(share, 0.0, 1.0)
    rest = 1.0 - share
    opposite = rest * (2.0 * along_b - rest * bb - 2.0 * share * bc)
    opposite += share * (2.0 * along_c - share * cc)
    better = opposite > gain
    return (np.where(better, rest, v), np.where(better, share, w), np.where(better, opposite, gain))


@dataclass(frozen=True)
class NearestPoints:
    """The points of a surface nearest to n given points, their distances, mm, and triangles."""

    positions: np.ndarray
    distances: np.ndarray
    triangles: np.ndarray

    def taken(self, rows: np.ndarray) -> NearestPoints:
        return NearestPoints(self.positions[rows], self.distances[rows], self.triangles[rows])


class TriangleTree:
    """The boxes of a mesh's triangles, in the order of `sides`, of which the last is repeated."""

    def __init__(self, corners: np.ndarray) -> None:
        levels = max(int(np.ceil(np.log2(max(len(corners) / LEAF, 1.0)))), 0)
        # Halves, quarters … of this order are compact; the last triangle is repeated.
        order, centers = np.arange(LEAF * 2**levels), corners.mean(axis=1)
        order[len(centers) :] = len(centers) - 1
        for level in range(levels):
            rows = order.reshape(2**level, -1)
            places = centers[rows]
            axis = np.ptp(places, axis=1).argmax(axis=1)
            keys = np.take_along_axis(places, axis[:, None, None], axis=2)[:, :, 0]
            order = np.take_along_axis(rows, keys.argsort(axis=1, kind="stable"), axis=1).ravel()
        self._order = order
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
        # A box as far away as the known triangle may hold a nearer one.
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
        """Return pairs of point (p,) and triangle in `sides` (p,), sorted by point.

        None within the squared distances (n,), mm², is missing; some pairs are farther apart.
        """
        last = len(self._boxes) - 1
        level = min(TOP_LEVEL, last)
        near = _is_within(self._boxes[level][None], points[:, None], squares[:, None])
        who, leaf = np.nonzero(near)
        while level < last:
            level += 1
            who = np.repeat(who, 2)
            leaf = (leaf[:, None] * 2 + np.arange(2)).ravel()
            kept = _is_within(self._boxes[level].take(leaf, axis=0), points[who], squares[who])
            who, leaf = who[kept], leaf[kept]
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


POOR_GUESS_MM = 2.0


class FollowedPoints:
    """The search for points that move by ever smaller steps; as `TriangleTree.nearest`.

    A point whose nearest triangle is d away finds it, after a move by at most m, among the
    triangles that were within d + 2m before. So these are kept, and are all that is tried until it
    moves farther than `slack_mm`, for all or for each (n,).
    """

    def __init__(
        self, tree: TriangleTree, points: np.ndarray, slack_mm: float | np.ndarray
    ) -> None:
        count = len(points)
        self._tree = tree
        self._anchors = np.array(points, dtype=float)
        self._slack = np.full(count, -1.0)
        self._who = self._triangle = np.zeros(0, dtype=np.int64)
        self._sides = tree.sides.taken(self._triangle)
        self._starts = np.zeros(count, dtype=np.int64)
        self._search(self._anchors, np.arange(count), np.full(count, slack_mm, dtype=float), None)
        self.nearest, self._places = self._nearest_of(self._anchors)

    def keep(self, rows: np.ndarray) -> None:
        """Follow only some of the points, (k,) int ascending; they are numbered anew."""
        number = np.full(len(self._anchors), -1)
        number[rows] = np.arange(len(rows))
        self._anchors, self._slack = self._anchors[rows], self._slack[rows]
        self.nearest, self._places = self.nearest.taken(rows), self._places[rows]
        who = number[self._who]
        pairs = np.flatnonzero(who >= 0)
        self._set_pairs(who[pairs], self._triangle[pairs])

    def repeat(self, slack_mm: np.ndarray) -> None:
        """Follow copies of the points, one set after the other.

        `slack_mm` (k, n) limits how far each copy of each point moves from here; no copy may exceed
        its point's own slack.
        """
        copies, count = slack_mm.shape
        squares, _, _ = self._sides.nearest(self._anchors[self._who])
        least = np.minimum.reduceat(squares, self._starts)
        near = squares <= _widened(least, slack_mm)[:, self._who]
        copy, pair = np.nonzero(near)
        self._anchors = np.tile(self._anchors, (copies, 1))
        self._slack = slack_mm.ravel()
        rows = np.tile(np.arange(count), copies)
        self.nearest, self._places = self.nearest.taken(rows), self._places[rows]
        self._set_pairs(self._who[pair] + count * copy, self._triangle[pair])

    def move(self, points: np.ndarray, slack_mm: np.ndarray) -> NearestPoints:
        """Return the nearest points of where the points (n, 3) have moved.

        `slack_mm` (n,) is by how much each is expected to move from here.
        """
        away = np.sum((points - self._anchors) ** 2, axis=1)
        lost = np.flatnonzero(away > self._slack**2)
        if len(lost):
            self._search(points, lost, slack_mm[lost], self._places[lost])
        self.nearest, self._places = self._nearest_of(points)
        return self.nearest

    def _nearest_of(self, points: np.ndarray) -> tuple[NearestPoints, np.ndarray]:
        squares, v, w = self._sides.nearest(points[self._who])
        best = least_of_each(squares, self._starts, self._who)
        places = self._triangle[best]
        return self._tree.found(points, places, v[best], w[best]), places

    def _search(
        self, points: np.ndarray, lost: np.ndarray, slack: np.ndarray, guess: np.ndarray | None
    ) -> None:
        """Find the triangles anew for some of the points, from a triangle near each."""
        at = points[lost]
        if guess is None:
            reach = self._tree.reach(at)
        else:
            reach = self._tree.sides.taken(guess).nearest(at)[0]
            poor = np.flatnonzero(reach > POOR_GUESS_MM**2)
            if len(poor):
                reach[poor] = np.minimum(reach[poor], self._tree.reach(at[poor]))
        who, triangle = self._tree.nearby(at, _widened(reach, slack))
        squares, _, _ = self._tree.sides.taken(triangle).nearest(at[who])
        least = np.minimum.reduceat(squares, np.searchsorted(who, np.arange(len(lost))))
        near = np.flatnonzero(squares <= _widened(least, slack)[who])
        self._anchors[lost], self._slack[lost] = at, slack
        is_lost = np.zeros(len(self._anchors), dtype=bool)
        is_lost[lost] = True
        others = np.flatnonzero(~is_lost[self._who])
        who = np.concatenate([self._who[others], lost[who[near]]])
        triangle = np.concatenate([self._triangle[others], triangle[near]])
        order = who.argsort(kind="stable")
        self._set_pairs(who[order], triangle[order])

    def _set_pairs(self, who: np.ndarray, triangle: np.ndarray) -> None:
        self._who, self._triangle = who, triangle
        self._sides = self._tree.sides.taken(triangle)
        self._starts = np.searchsorted(who, np.arange(len(self._anchors)))


def _widened(squares: np.ndarray, slack: np.ndarray) -> np.ndarray:
    """Return (d + 2m)², (n,) float, a little more, for d² and m."""
    return np.asarray((np.sqrt(squares) + 2.0 * slack) ** 2 * (1.0 + 1e-9) + 1e-12)
