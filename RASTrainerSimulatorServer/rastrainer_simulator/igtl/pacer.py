"""When something that is sent at a rate is due, on a clock that may run fast or start again."""

from __future__ import annotations

import math

_TOLERANCE_S = 1e-9


class Pacer:
    """Says when the next of `hz` moments a second has come; never with 0 Hz."""

    def __init__(self, hz: float):
        self._period = 1.0 / hz if hz > 0 else math.inf
        self.next = -math.inf if hz > 0 else math.inf

    def is_due(self, now: float) -> bool:
        """Return whether the next moment has come, and plan the one after it.

        The rate holds on average although `now` comes in ticks; moments that were missed are not
        made up for.
        """
        has_restarted = now + 1.5 * self._period < self.next < math.inf
        if now < self.next - _TOLERANCE_S and not has_restarted:
            return False
        self.next += self._period
        if not now < self.next <= now + self._period:
            self.next = now + self._period
        return True
