"""Limits on how often something may happen and how long it may take."""

from __future__ import annotations

import asyncio
import math
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
    """Limits of all trials; further ones are refused.

    Each makes a journal, and its start takes as long as several ticks.

    Attributes:
        starts_per_s: trials that may be started in a simulated second, on average.
        starts_at_once: trials that may be started at once after a pause.
    """

    starts_per_s: float = 0.2
    starts_at_once: int = 4


_TOLERANCE_S = 1e-9
_SAVED_AT_MOST_S = 0.02


class AsyncRateLimiter:
    """Lets `per_s` pass in a second on average, and as many at once after a quiet second.

    It belongs to one event loop. A waiting task does not block the others.
    """

    def __init__(self, per_s: float) -> None:
        self._period_s = 1.0 / per_s
        self._next = -1.0

    async def passed(self) -> None:
        """Return when it is the caller's turn."""
        now = asyncio.get_running_loop().time()
        self._next = max(self._next, now - 1.0) + self._period_s
        if self._next > now:
            await asyncio.sleep(self._next - now)


class Pacer:
    """Times events at `hz` per second; none at 0 Hz."""

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


class ReadingBudget:
    """Time to spend on a client's bytes: it grows steadily, and a debt makes the client wait.

    A client that sends much, or what is costly to read, is read later and never delays the control
    loop. A new client has nothing saved, so that connecting again gains nothing.
    """

    def __init__(self, now: float):
        self._saved = 0.0
        self._since = now

    def charge(self, spent: float, share: float, now: float) -> float:
        """Take `spent` seconds off a budget that grows by `share` of the time.

        Returns how long nothing more may be read, in s.
        """
        earned = self._saved + share * (now - self._since)
        self._saved = min(earned, _SAVED_AT_MOST_S) - spent
        self._since = now
        return max(0.0, -self._saved / share)
