"""The clearances of the arm, and lower bounds of them as the arm moves."""

from __future__ import annotations

from collections.abc import Callable
from heapq import heapify, heappop, heappush
from typing import NamedTuple

import numpy as np

from rastrainer_simulator.vectors import Vector

FAR = 0.1
"""Clearances of links, self and table are exact up to this value, m, which is their maximum."""

SHAFT_NEAR = 0.0015
"""The shaft's clearance is exact up to this value, m, and where it is less than the tip's."""


class Nearest(NamedTuple):
    """The point of the head's surface that is nearest to the tip or to the shaft.

    Attributes:
        distance_m: signed clearance, m; below zero inside the head.
        point: on the surface, m.
        normal: unit vector away from the head, along which the clearance grows.
        triangle: of the head's surface, by its number.
    """

    distance_m: float
    point: Vector
    normal: Vector
    triangle: int


class Clearance(NamedTuple):
    """Signed clearances of one posture, in m (below zero: overlap); points and normals in World.

    Attributes:
        tip: the very tip of the tool against the head.
        shaft: the rest of the tool against the head, where it is near (see `SHAFT_NEAR`), else
            None; it starts 3 mm behind the tip.
        links_m: the links, flange included, against the head; at most FAR.
        links_worst: the link that is nearest to the head, "" where none is within FAR.
        self_m: the arm against itself, links at least three joints apart; at most FAR.
        self_worst: the two links nearest to each other, () where none are within FAR.
        table_m: arm and tool against the table and the head's stand; at most FAR.
        table_worst: the link nearest to them, "" where none is within FAR.
    """

    tip: Nearest
    shaft: Nearest | None
    links_m: float
    links_worst: str
    self_m: float
    self_worst: tuple[str, ...]
    table_m: float
    table_worst: str

    @property
    def tip_m(self) -> float:
        """Signed clearance of the tip to the head, m."""
        return self.tip.distance_m

    @property
    def shaft_m(self) -> float:
        """Signed clearance of the tool without its tip to the head, m; a lower bound if far."""
        return max(self.tip_m, SHAFT_NEAR) if self.shaft is None else self.shaft.distance_m

    @property
    def tool_m(self) -> float:
        """Signed clearance of the whole tool to the head, m: what the trainee is shown."""
        return min(self.tip_m, self.shaft_m)

    @property
    def worst(self) -> str:
        """The nearest part: "tip", "shaft", "links", "self" or "table"."""
        parts = ("tip", "shaft", "links", "self", "table")
        return min(parts, key=lambda part: getattr(self, f"{part}_m"))


_ROUGHLY_FAR = 0.2
"""Distances whose rough bound is above this, m, are not measured exactly."""

_FEW = 4
"""If more than this are due, the arm has jumped: rough bounds of all are quicker."""

_ROUNDING = 1e-6


class DistanceBounds:
    """Keeps track of which of n distances may be below FAR.

    A distance d cannot fall below FAR before the arm has moved by d − FAR: until then it is not
    measured again. So most ticks measure nothing, and hardly any tick many.
    """

    def __init__(self, count: int, closing: float = 1.0) -> None:
        """Track `count` distances, each of which shrinks at most by `closing` m per metre."""
        self._count = count
        self._closing = closing
        self.forget()

    def forget(self) -> None:
        """Make all due, as after something else than the arm has moved."""
        self._due = [(-1.0, row) for row in range(self._count)]

    def due(self, travelled: float, rough: Callable[[], np.ndarray] | None = None) -> list[int]:
        """Return the rows that may be below FAR, rising; each must then be `put_off`.

        Args:
            travelled: total motion of the arm, m.
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
        self, travelled: float, distance: Callable[[int], float], rough: Callable[[], np.ndarray]
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
        """Make a row due again when it may be below FAR; it is now at least `distance`, m."""
        until = travelled + (distance - FAR - _ROUNDING) / self._closing
        heappush(self._due, (until, row))

    def _roughly_near(self, rows: list[int], bounds: np.ndarray, travelled: float) -> list[int]:
        """Put off those of `rows` and of the other due ones that are far; return the rest."""
        rows = rows + [row for moment, row in self._due if moment <= travelled]
        until = (travelled + (bounds - FAR - _ROUNDING) / self._closing).tolist()
        far = (bounds >= _ROUGHLY_FAR).tolist()
        waiting = [entry for entry in self._due if entry[0] > travelled]
        self._due = [*waiting, *((until[row], row) for row in rows if far[row])]
        heapify(self._due)
        return [row for row in rows if not far[row]]
