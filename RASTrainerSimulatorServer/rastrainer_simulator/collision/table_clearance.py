"""The arm against the table on which it stands, and against the stand under the head."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rastrainer_simulator.collision.posed_arm import ArmCapsules, PosedArm
from rastrainer_simulator.collision.segment_distance import segment_distance


@dataclass(frozen=True)
class Surroundings:
    """What stands around: lengths in m, World.

    Attributes:
        table_height: of the table top; the robot's base stands on it and is not checked.
        stand_radius: of the upright column under the middle of the head's base.
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
        self._moving = np.where(arm.joints > 0, 0.0, math.inf)

    def put_stand_under(self, base: np.ndarray) -> None:
        """Put the stand under the middle of the head's base (3,) float, World."""
        x, y, top = base.tolist()
        top -= self._stand_radius  # The column is a capsule: its round end fills up to the base.
        upright = top > self._table
        self._stand = ((x, y, self._table), (x, y, top)) if upright else None

    def nearest(self, posed: PosedArm) -> tuple[float, str]:
        """Return the least signed distance, m, and the link that is nearest."""
        heights = posed.ends[:, :, 2].min(axis=1) - self._arm.radii - self._table + self._moving
        row = int(heights.argmin())
        best = float(heights[row])
        tip = posed.tip[2] - self._table
        if tip < best:
            best, row = tip, len(heights) - 1
        if self._stand is not None:
            best, row = self._nearest_to_stand(posed, best, row)
        return best, self._arm.names[row]

    def _nearest_to_stand(self, posed: PosedArm, best: float, row: int) -> tuple[float, int]:
        start, end = self._stand
        aside = posed.middles[:, :2] - start[:2]
        bounds = np.sqrt(np.einsum("ij,ij->i", aside, aside)) - self._arm.reach
        bounds += self._moving - self._stand_radius
        for other in np.flatnonzero(bounds < best).tolist():
            axis = segment_distance(*posed.ends[other].tolist(), start, end)
            distance = axis - self._arm.capsules[other].radius - self._stand_radius
            if distance < best:
                best, row = distance, other
        return best, row
