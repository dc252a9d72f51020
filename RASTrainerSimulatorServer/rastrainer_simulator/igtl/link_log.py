"""The link's log: whatever a client does, one line a second."""

from __future__ import annotations

import asyncio
import logging
from collections import Counter

_logger = logging.getLogger("rastrainer.igtl")

_PERIOD_S = 1.0
_MOST_KINDS = 20


class LinkLog:
    """Logs the first trouble at once and gathers what follows within a second into one line."""

    def __init__(self):
        self._counts: Counter[str] = Counter()
        self._timer: asyncio.TimerHandle | None = None

    def note(self, what: str, times: int = 1) -> None:
        """Log `what`, now or with others within a second."""
        known = what in self._counts or len(self._counts) < _MOST_KINDS
        self._counts[what if known else "more of other kinds"] += times
        if self._timer is None:
            self._write_in_turn()

    def close(self) -> None:
        """Write what is left."""
        if self._timer is not None:
            self._timer.cancel()
        self._write()

    def _write_in_turn(self) -> None:
        """Write, and again after a second if something new has come by then."""
        self._timer = None
        if self._counts:
            self._write()
            self._timer = asyncio.get_running_loop().call_later(_PERIOD_S, self._write_in_turn)

    def _write(self) -> None:
        if self._counts:
            parts = [f"{times} × {what}" for what, times in self._counts.items()]
            _logger.warning("%s", "; ".join(parts))
            self._counts.clear()
