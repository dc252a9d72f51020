"""How long a study's file is waited for while another program has it locked."""

from __future__ import annotations

import time
from collections.abc import Callable

BUSY_TIMEOUT_S = 30.0
INTERACTIVE_TIMEOUT_S = 0.05
"""Nobody notices so short a wait in a window."""
REST_S = 1.0


class Patience:
    """Waits for a lock, and after a wait in vain no more for a while.

    A panel asks a study ten questions in a row: with a lock held elsewhere it waits once, not ten
    times. Several connections may share one.
    """

    def __init__(
        self,
        most_s: float = BUSY_TIMEOUT_S,
        rest_s: float = 0.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Wait `most_s` for a lock, but not within `rest_s` after a wait in vain."""
        self._most_s, self._rest_s, self._clock = most_s, rest_s, clock
        self._rests_until = float("-inf")
        self._is_lost = False

    @classmethod
    def interactive(cls) -> Patience:
        """Return that of a thread which draws a window."""
        return cls(INTERACTIVE_TIMEOUT_S, REST_S)

    @property
    def timeout_s(self) -> float:
        """How long to wait now."""
        return 0.0 if self._clock() < self._rests_until else self._most_s

    def lose(self) -> None:
        """Note a wait in vain."""
        self._is_lost = True
        if self._clock() >= self._rests_until:
            self._rests_until = self._clock() + self._rest_s

    def regained(self) -> bool:
        """Return whether, after a wait in vain, it is time to look again; true once."""
        is_rested = self._is_lost and self._clock() >= self._rests_until
        self._is_lost = self._is_lost and not is_rested
        return is_rested
