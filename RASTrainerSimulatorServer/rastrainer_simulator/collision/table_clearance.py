"""The arm against the table on which it stands, and against the stand under the head."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np

from rastrainer_simulator.collision.distance_bounds import DistanceBounds
from rastrainer_simulator.collision.posed_arm import ArmCapsules, PosedArm
from rastrainer_simulator.collision.segments import segment_distance


@dataclass(frozen=True)
class Surroundings:
    """What stands around: lengths in m, World.

    Attributes:
        table_height: of the table top; the robot's base stands on it and is not checked.
        stand_radius: of the upright column under the middle of the head's base; 0: no stand.
    """

    table_height: float = 0.0
    stand_radius: float = 0.04


class TableClearance:
    """The least distance of the moving links and the tool to the table and to the stand."""

    def __init__(self, arm: ArmCapsules, surroundings: Surroundings) -> None:
        self._arm = arm
        self._table = surroundings.table_height
        self._stand_radius = surroundings.stand_radius
        self._stand: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None
        self._distance_bounds = DistanceBounds(len(arm.capsules))
        fixed = np.where(arm.joints > 0, 0.0, -math.inf)
        self._below = arm.radii + surroundings.table_height + fixed
        self._around = arm.reach + surroundings.stand_radius + fixed

    def put_stand_under(self, base: np.ndarray) -> None:
        """Put the stand under the middle of the head's base (3,) float, World."""
        x, y, top = base.tolist()
        top -= self._stand_radius  # The column is a capsule: its round end fills up to the base.
        upright = self._stand_radius > 0.0 and top > self._table
        self._stand = ((x, y, self._table), (x, y, top)) if upright else None
        self._distance_bounds.forget()

    def nearest(self, posed: PosedArm, travelled: float) -> tuple[float, str]:
        """Return the least signed distance to table and stand, m, and the link.

        The distance is at most FAR, and then no link is named. `travelled` is how far the arm has
        moved in all, m.
        """
        best, row = self._distance_bounds.nearest(
            travelled, partial(self._distance, posed), partial(self._bounds, posed)
        )
        name = "" if row is None else self._arm.names[row]
        # The tip is no part of a capsule; it is the tool's, which is last.
        above = posed.tip[2] - self._table
        return (above, self._arm.names[-1]) if above < best else (best, name)

    def _bounds(self, posed: PosedArm) -> np.ndarray:
        """Return below what the distance of no capsule can be, (n,) float, m."""
        bounds = np.minimum(posed.ends[:, 0, 2], posed.ends[:, 1, 2]) - self._below
        if self._stand is None:
            return bounds
        away = posed.middles - self._stand[1]
        np.maximum(away[:, 2], 0.0, out=away[:, 2])
        return np.minimum(bounds, np.sqrt(np.einsum("ij,ij->i", away, away)) - self._around)

    def _distance(self, posed: PosedArm, row: int) -> float:
        start, end = posed.axis(row)
        distance = min(start[2], end[2]) - self._below[row]
        if self._stand is None:
            return distance
        radii = self._arm.capsules[row].radius + self._stand_radius
        return min(distance, segment_distance(start, end, *self._stand) - radii)
