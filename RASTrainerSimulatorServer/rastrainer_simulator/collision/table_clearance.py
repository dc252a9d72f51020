"""The arm against the table on which it stands, and against the stand under the head."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rastrainer_simulator.collision.clearance import FAR
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

    def nearest(self, posed: PosedArm) -> tuple[float, str]:
        """Return the least signed distance, m, and the link that is nearest.

        Where that is FAR or more, a lower bound of it and "".
        """
        heights = np.minimum(posed.ends[:, 0, 2], posed.ends[:, 1, 2]) - self._below
        row = int(heights.argmin())
        best, name = float(heights[row]), self._arm.names[row]
        tip = posed.tip[2] - self._table
        if tip < best:
            best, name = tip, self._arm.names[-1]
        if self._stand is not None:
            best, name = self._nearest_to_stand(posed, best, name)
        return best, name if best < FAR else ""

    def _nearest_to_stand(self, posed: PosedArm, best: float, name: str) -> tuple[float, str]:
        start, end = self._stand
        away = posed.middles - end
        np.maximum(away[:, 2], 0.0, out=away[:, 2])
        bounds = np.sqrt(np.einsum("ij,ij->i", away, away)) - self._around
        is_near = bounds < FAR
        best = min(best, float(bounds.min(initial=math.inf, where=~is_near)))
        for row in np.flatnonzero(is_near).tolist():
            axes = segment_distance(*posed.axis(row), start, end)
            distance = axes - self._arm.capsules[row].radius - self._stand_radius
            if distance < best:
                best, name = distance, self._arm.names[row]
        return best, name
