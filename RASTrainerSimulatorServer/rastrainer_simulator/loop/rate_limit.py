"""How often something may happen, and how often trials may be begun."""

from __future__ import annotations

from dataclasses import dataclass


class RateLimit:
    """Allows `per_s` times a second on average, and `at_once` after a pause (a token bucket)."""

    def __init__(self, per_s: float, at_once: float) -> None:
        self._per_s = per_s
        self._at_once = at_once
        self._left = at_once
        self._since = 0.0

    def allows(self, now: float) -> bool:
        """Count one more at the time `now` (s); return whether it is within the limit."""
        self._left = min(self._at_once, self._left + (now - self._since) * self._per_s)
        self._since = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


@dataclass(frozen=True)
class TrialLimits:
    """Limits of the trials, whoever begins them; further ones are refused.

    Each makes a journal, and to begin it is as much work as several ticks.

    Attributes:
        starts_per_s: trials that may be begun in a simulated second, on average, and
        starts_at_once: so many at once after a pause.
    """

    starts_per_s: float = 0.2
    starts_at_once: int = 4
