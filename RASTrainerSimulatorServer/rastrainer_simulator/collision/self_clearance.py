"""The arm against itself."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from rastrainer_simulator.collision.clearance import FAR, take_close
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
        self._close: list[int] = []

    def look(self, posed: PosedArm) -> np.ndarray:
        """Find the pairs that are close; return a bound for each of the arm's capsules, (n,) float.

        It is at least so far away, m, from those with which it is in no close pair.
        """
        middles = posed.middles
        between = middles.take(self._first, 0) - middles.take(self._second, 0)
        bounds = np.sqrt(np.einsum("ij,ij->i", between, between)) - self._reaches
        self._close = take_close(bounds, partial(self._distance, posed))
        of_capsules = np.full(len(posed.ends), math.inf)
        np.minimum.at(of_capsules, self._first, bounds)
        np.minimum.at(of_capsules, self._second, bounds)
        return of_capsules

    def nearest(self, posed: PosedArm) -> tuple[float, tuple[str, ...]]:
        """Return the least signed distance of the close pairs, m, and the two links.

        The distance is at most FAR, and then no links are named.
        """
        best, names = FAR, ()
        for pair in self._close:
            distance = self._distance(posed, pair)
            if distance < best:
                best, names = distance, self._names[pair]
        return best, names

    def _distance(self, posed: PosedArm, pair: int) -> float:
        first, second = self._pairs[pair]
        return segment_distance(*posed.axis(first), *posed.axis(second)) - self._radii[pair]
