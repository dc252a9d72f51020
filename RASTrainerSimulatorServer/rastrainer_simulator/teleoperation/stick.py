"""From the position of a stick to a share of the full speed."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class StickResponse:
    """How a stick's deflection becomes a speed.

    Attributes:
        dead_zone: share of the stick's travel that counts as released, 0…1. The zone is round, so
            that a diagonal deflection is not bent toward an axis.
        exponent: of the response curve; 1 is linear, larger is gentler near the center.
    """

    dead_zone: float = 0.12
    exponent: float = 2.0

    def __call__(self, deflection: tuple[float, ...]) -> tuple[float, ...]:
        """Return the share of the full speed along each axis, its length 0…1.

        Values that are not finite count as released: a broken gamepad must not move the arm.
        """
        size = math.hypot(*deflection)
        if not self.dead_zone < size < math.inf:
            return (0.0,) * len(deflection)
        share = min(1.0, (size - self.dead_zone) / (1.0 - self.dead_zone)) ** self.exponent
        return tuple(value * share / size for value in deflection)
