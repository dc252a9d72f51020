"""What may have come near, judged by how far the arm has moved since it was last measured."""

from __future__ import annotations

from collections.abc import Callable
from heapq import heapify, heappop, heappush

import numpy as np

from rastrainer_simulator.collision.clearance import FAR

_ROUGHLY_FAR = 0.2
"""What is farther than this, m, by a rough bound is not looked at exactly."""

_FEW = 4
"""When more than this are due, the arm has jumped: a rough look at all at once is quicker."""

_ROUNDING = 1e-6


class DistanceBounds:
    """Tells which of n distances may be below FAR.

    A distance that is known to be d cannot be below FAR before the arm has moved by d − FAR: until
    then nobody asks for it again. So most ticks look at nothing, and hardly any at many.
    """

    def __init__(self, count: int, closing: float = 1.0) -> None:
        """Watch over `count` distances, each of which shrinks at most by `closing` m a metre."""
        self._count = count
        self._closing = closing
        self.forget()

    def forget(self) -> None:
        """Let all be due: something else than the arm has moved."""
        self._due = [(-1.0, row) for row in range(self._count)]

    def due(self, travelled: float, rough: Callable[[], np.ndarray] | None = None) -> list[int]:
        """Return the rows that may be below FAR, rising; each must then be `put_off`.

        Args:
            travelled: how far the arm has moved in all, m.
            rough: gives a lower bound of each distance, (count,) float, m.
        """
        due, rows = self._due, []
        while due and due[0][0] <= travelled:
            rows.append(heappop(due)[1])
            if rough is not None and len(rows) > _FEW:
                rows = self._roughly_near(rows, rough(), travelled)
                break
        rows.sort()
        return rows

    def nearest(
        self,
        travelled: float,
        distance: Callable[[int], float],
        rough: Callable[[], np.ndarray],
    ) -> tuple[float, int | None]:
        """Return the least distance, m, and its row; FAR and None where all are farther.

        `distance` gives that of a row, m; for the others see `due`.
        """
        best, nearest = FAR, None
        for row in self.due(travelled, rough):
            found = distance(row)
            self.put_off(row, found, travelled)
            if found < best:
                best, nearest = found, row
        return best, nearest

    def put_off(self, row: int, distance: float, travelled: float) -> None:
        """Let a row be due again once it may be below FAR; it is now at least `distance`, m."""
        until = travelled + (distance - FAR - _ROUNDING) / self._closing
        heappush(self._due, (until, row))

    def _roughly_near(self, rows: list[int], bounds: np.ndarray, travelled: float) -> list[int]:
        """Put off what is roughly far of `rows` and of what else is due; return the others."""
        rows = rows + [row for moment, row in self._due if moment <= travelled]
        until = (travelled + (bounds - FAR - _ROUNDING) / self._closing).tolist()
        far = (bounds >= _ROUGHLY_FAR).tolist()
        waiting = [entry for entry in self._due if entry[0] > travelled]
        self._due = [*waiting, *((until[row], row) for row in rows if far[row])]
        heapify(self._due)
        return [row for row in rows if not far[row]]
