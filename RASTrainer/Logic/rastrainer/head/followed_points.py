"""Nearest points on a surface for points that move by ever smaller steps, as in a fit.

A point whose nearest triangle is d away finds it, after a move by at most m, among the triangles
that were within d + 2m before. So these are kept, and are all that is tried until it moves farther.
"""

from __future__ import annotations

import numpy as np

from rastrainer.head.triangle_tree import NearestPoints, TriangleTree, least_of_each

POOR_GUESS_MM = 2.0


class FollowedPoints:
    """The search for points that move; the answer is that of `TriangleTree.nearest`.

    Args:
        tree: Of the surface.
        points: (n, 3) float, mm, where they are now.
        slack_mm: By how much they are to move before the surface is searched again, for all or
            for each (n,).
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
        self._found = self._nearest_of(self._anchors)

    @property
    def nearest(self) -> NearestPoints:
        """The nearest points of where the points are."""
        return self._found[0]

    def keep(self, rows: np.ndarray) -> None:
        """Follow only some of the points, (k,) int ascending; they are numbered anew."""
        number = np.full(len(self._anchors), -1)
        number[rows] = np.arange(len(rows))
        self._anchors, self._slack = self._anchors[rows], self._slack[rows]
        (found, places) = self._found
        self._found = _rows_of(found, rows), places[rows]
        who = number[self._who]
        pairs = np.flatnonzero(who >= 0)
        self._set_pairs(who[pairs], self._triangle[pairs])

    def repeat(self, slack_mm: np.ndarray) -> None:
        """Follow copies of the points, one set after the other.

        Args:
            slack_mm: (k, n) float, by how much each copy of each point is to move from here, at
                most what it was for the point itself.
        """
        copies, count = slack_mm.shape
        squares, _, _ = self._sides.nearest(self._anchors[self._who])
        least = np.minimum.reduceat(squares, self._starts)
        near = squares <= _widened(least, slack_mm)[:, self._who]
        copy, pair = np.nonzero(near)
        self._anchors = np.tile(self._anchors, (copies, 1))
        self._slack = slack_mm.ravel()
        (found, places) = self._found
        rows = np.tile(np.arange(count), copies)
        self._found = _rows_of(found, rows), places[rows]
        self._set_pairs(self._who[pair] + count * copy, self._triangle[pair])

    def move(self, points: np.ndarray, slack_mm: np.ndarray) -> NearestPoints:
        """Return the nearest points (n,) of where the points have moved.

        Args:
            points: (n, 3) float, mm.
            slack_mm: (n,) float, by how much each is expected to move from here.
        """
        away = np.sum((points - self._anchors) ** 2, axis=1)
        lost = np.flatnonzero(away > self._slack**2)
        if len(lost):
            self._search(points, lost, slack_mm[lost], self._found[1][lost])
        self._found = self._nearest_of(points)
        return self._found[0]

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


def _rows_of(found: NearestPoints, rows: np.ndarray) -> NearestPoints:
    return NearestPoints(found.positions[rows], found.distances[rows], found.triangles[rows])


def _widened(squares: np.ndarray, slack: np.ndarray) -> np.ndarray:
    """Return (d + 2m)², (n,) float, a little more, for d² and m."""
    return np.asarray((np.sqrt(squares) + 2.0 * slack) ** 2 * (1.0 + 1e-9) + 1e-12)
