"""How often something may happen."""

from __future__ import annotations


class RateLimit:
    """Allows `per_s` times a second on average (a token bucket), and as many or one at once."""

    def __init__(self, per_s: float) -> None:
        self._per_s = per_s
        self._most = max(per_s, 1.0)
        self._left = self._most
        self._since = 0.0

    def allows(self, now: float) -> bool:
        """Count one more at the time `now` (s); return whether it is within the limit."""
        self._left = min(self._most, self._left + (now - self._since) * self._per_s)
        self._since = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
