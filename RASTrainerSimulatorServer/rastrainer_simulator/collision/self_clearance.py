"""The arm against itself."""

from __future__ import annotations

import math

import numpy as np

from rastrainer_simulator.collision.clearance import FAR, LOOK
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

    def nearest(self, posed: PosedArm) -> tuple[float, tuple[str, ...], np.ndarray]:
        """Return the least signed distance, m, the two links, and a bound for each capsule.

        The distance is at most FAR, and then no links are named. The bounds, (n,) float, are what
        each of the arm's capsules is at least away from the others.
        """
        middles = posed.middles
        between = middles.take(self._first, 0) - middles.take(self._second, 0)
        bounds = np.sqrt(np.einsum("ij,ij->i", between, between)) - self._reaches
        for pair in np.flatnonzero(bounds < LOOK).tolist():
            first, second = self._pairs[pair]
            axes = segment_distance(*posed.axis(first), *posed.axis(second))
            bounds[pair] = axes - self._radii[pair]
        of_capsules = np.full(len(posed.ends), math.inf)
        np.minimum.at(of_capsules, self._first, bounds)
        np.minimum.at(of_capsules, self._second, bounds)
        if bounds.min(initial=math.inf) >= FAR:
            return FAR, (), of_capsules
        best = int(bounds.argmin())
        return float(bounds[best]), self._names[best], of_capsules
