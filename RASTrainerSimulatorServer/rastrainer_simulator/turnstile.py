"""A turnstile: so many pass in a second, the others wait for their turn."""

from __future__ import annotations

import asyncio


class Turnstile:
    """Lets `per_s` pass in a second on average, and as many at once after a quiet second.

    It belongs to one event loop. Who waits keeps nobody else from being served, and costs nothing.
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
