"""Triangles as a corner and two sides: the nearest point of each to a given point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_CORNER, _TO_B, _TO_C = slice(0, 3), slice(3, 6), slice(6, 9)


@dataclass(frozen=True)
class TriangleSides:
    """Triangles with the products that a search for nearest points needs, mm.

    Attributes:
        rows: (m, 12) float: the first corner, from it to the second (b) and to the third (c), and
            b·b, b·c and c·c; side by side, since picking rows is what takes the time.
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
        """Return some of the triangles, (p,) int."""
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


def least_of_each(squares: np.ndarray, starts: np.ndarray, who: np.ndarray) -> np.ndarray:
    """Return the first pair of each point whose square is least, (n,) int.

    Args:
        squares: (p,) float, of pairs of point and triangle.
        starts: (n,) int, the first pair of each point; every point has one or more.
        who: (p,) int, ascending, the point of each pair.
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
    return (
        np.where(better, rest, v),
        np.where(better, share, w),
        np.where(better, opposite, gain),
    )
