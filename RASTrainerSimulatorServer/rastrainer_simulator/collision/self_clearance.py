"""The arm against itself."""

from __future__ import annotations

import math

import numpy as np

from rastrainer_simulator.collision.clearance import FAR
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

    def nearest(self, posed: PosedArm) -> tuple[float, tuple[str, ...]]:
        """Return the least signed distance, m, and the two links it is between.

        Where that is FAR or more, a lower bound of it and no links.
        """
        middles = posed.middles
        between = middles.take(self._first, 0) - middles.take(self._second, 0)
        bounds = np.sqrt(np.einsum("ij,ij->i", between, between)) - self._reaches
        is_near = bounds < FAR
        best, names = float(bounds.min(initial=math.inf, where=~is_near)), ()
        for pair in np.flatnonzero(is_near).tolist():
            first, second = self._pairs[pair]
            axes = segment_distance(*posed.axis(first), *posed.axis(second))
            distance = axes - self._radii[pair]
            if distance < best:
                best, names = distance, self._names[pair] if distance < FAR else ()
        return best, names
