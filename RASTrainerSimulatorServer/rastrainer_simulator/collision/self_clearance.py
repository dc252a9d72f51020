"""The arm against itself."""

from __future__ import annotations

from functools import partial

import numpy as np

from rastrainer_simulator.collision.lookout import Lookout
from rastrainer_simulator.collision.posed_arm import ArmCapsules, PosedArm
from rastrainer_simulator.collision.segment_distance import segment_distance

APART = 3
"""Links this many joints apart are checked; joint limits keep nearer ones from touching."""


class SelfClearance:
    """The least distance between links that could touch each other."""

    def __init__(self, arm: ArmCapsules) -> None:
        """Take the capsules of an arm; those of one body, or of near links, are never compared."""
        first, second = np.triu_indices(len(arm.capsules), k=1)
        apart = np.abs(arm.joints[first] - arm.joints[second]) >= APART
        self._first, self._second = first[apart], second[apart]
        self._pairs = list(zip(self._first.tolist(), self._second.tolist(), strict=True))
        self._reaches = arm.reach[self._first] + arm.reach[self._second]
        self._radii = (arm.radii[self._first] + arm.radii[self._second]).tolist()
        self._names = [(arm.names[i], arm.names[j]) for i, j in self._pairs]
        # Both of a pair may move toward each other.
        self._lookout = Lookout(len(self._pairs), closing=2.0)

    def nearest(self, posed: PosedArm, travelled: float) -> tuple[float, tuple[str, ...]]:
        """Return the least signed distance of two links, m, and the two.

        The distance is at most FAR, and then no links are named. `travelled` is how far the arm has
        moved since ever, m.
        """
        best, pair = self._lookout.nearest(
            travelled, partial(self._distance, posed), partial(self._bounds, posed)
        )
        return best, () if pair is None else self._names[pair]

    def _bounds(self, posed: PosedArm) -> np.ndarray:
        """Return below what the distance of no pair can be, (pairs,) float, m."""
        middles = posed.middles
        between = middles.take(self._first, 0) - middles.take(self._second, 0)
        return np.sqrt(np.einsum("ij,ij->i", between, between)) - self._reaches

    def _distance(self, posed: PosedArm, pair: int) -> float:
        first, second = self._pairs[pair]
        return segment_distance(*posed.axis(first), *posed.axis(second)) - self._radii[pair]
