"""The arm against the table on which it stands, and against the stand under the head."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rastrainer_simulator.collision.clearance import FAR, LOOK
from rastrainer_simulator.collision.posed_arm import ArmCapsules, PosedArm
from rastrainer_simulator.collision.segment_distance import segment_distance


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
        fixed = np.where(arm.joints > 0, 0.0, -math.inf)
        self._below = arm.radii + surroundings.table_height + fixed
        self._around = arm.reach + surroundings.stand_radius + fixed

    def put_stand_under(self, base: np.ndarray) -> None:
        """Put the stand under the middle of the head's base (3,) float, World."""
        x, y, top = base.tolist()
        top -= self._stand_radius  # The column is a capsule: its round end fills up to the base.
        upright = self._stand_radius > 0.0 and top > self._table
        self._stand = ((x, y, self._table), (x, y, top)) if upright else None

    def nearest(self, posed: PosedArm) -> tuple[float, str, np.ndarray]:
        """Return the least signed distance, m, the link that is nearest, and a bound for each.

        The distance is at most FAR, and then no link is named. The bounds, (n,) float, are what
        each of the arm's capsules is at least away.
        """
        bounds = np.minimum(posed.ends[:, 0, 2], posed.ends[:, 1, 2]) - self._below
        # The tip is the tool's, which is last.
        bounds[-1] = min(bounds[-1], posed.tip[2] - self._table)
        if self._stand is not None:
            bounds = np.minimum(bounds, self._to_stand(posed))
        best = int(bounds.argmin())
        if bounds[best] >= FAR:
            return FAR, "", bounds
        return float(bounds[best]), self._arm.names[best], bounds

    def _to_stand(self, posed: PosedArm) -> np.ndarray:
        """Return the distance of each capsule to the stand, (n,) float; of far ones a bound."""
        start, end = self._stand
        away = posed.middles - end
        np.maximum(away[:, 2], 0.0, out=away[:, 2])
        bounds = np.sqrt(np.einsum("ij,ij->i", away, away)) - self._around
        for row in np.flatnonzero(bounds < LOOK).tolist():
            axes = segment_distance(*posed.axis(row), start, end)
            bounds[row] = axes - self._arm.capsules[row].radius - self._stand_radius
        return bounds
