"""The arm against itself."""

from __future__ import annotations

import numpy as np

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
        self._reaches = arm.reach[self._first] + arm.reach[self._second]
        self._radii = (arm.radii[self._first] + arm.radii[self._second]).tolist()
        self._names = [
            (arm.names[i], arm.names[j]) for i, j in zip(self._first, self._second, strict=True)
        ]

    def nearest(self, posed: PosedArm) -> tuple[float, tuple[str, str]]:
        """Return the least signed distance, m, and the two links it is between."""
        between = posed.middles[self._first] - posed.middles[self._second]
        bounds = np.sqrt(np.einsum("ij,ij->i", between, between)) - self._reaches
        pair = int(bounds.argmin())
        best = self._distance(posed, pair)
        for other in np.flatnonzero(bounds < best).tolist():
            distance = self._distance(posed, other)
            if distance < best:
                best, pair = distance, other
        return best, self._names[pair]

    def _distance(self, posed: PosedArm, pair: int) -> float:
        first = posed.ends[self._first[pair]].tolist()
        second = posed.ends[self._second[pair]].tolist()
        return segment_distance(*first, *second) - self._radii[pair]
