"""How smoothly the window draws."""

from __future__ import annotations

from collections.abc import Callable

SECOND = 1.0


class FrameCount:
    """Counts the pictures of each second, and those that were due and did not come."""

    def __init__(self, report: Callable[[int, int], None], now: float):
        """`report` is told once a second how many were shown and how many dropped."""
        self._report = report
        self._since = now
        self._shown = self._due = 0

    def due(self) -> None:
        """Something to be drawn has arrived."""
        self._due += 1

    def shown(self) -> None:
        """A picture with all that has arrived was drawn."""
        self._shown += 1

    def tell(self, now: float) -> None:
        """Report if a second is over."""
        if now - self._since >= SECOND:
            self._report(self._shown, max(0, self._due - self._shown))
            self._since, self._shown, self._due = now, 0, 0
