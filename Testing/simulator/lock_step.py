"""A control loop that ticks only when a test wants it: nothing depends on how fast it is."""

from __future__ import annotations

import threading
from collections.abc import Callable

PATIENCE_S = 120.0


class LockStep:
    """Holds a control loop's own thread, and ticks in the test's.

    No time passes in the simulation while a change of the trial is being written.
    """

    def __init__(self, loop) -> None:
        self._loop = loop
        self._is_held, self._is_free = threading.Event(), threading.Event()
        self._tick_alone, loop._tick = loop._tick, self._hold

    def tick(self, count: int = 1) -> None:
        assert self._is_held.wait(PATIENCE_S), "the control loop does not run"
        for _ in range(count):
            self._tick_alone()
            if self._loop._held.is_waiting:
                self.write()

    def until(self, condition: Callable[[], bool]) -> None:
        while not condition():
            self.tick()

    def write(self) -> None:
        """Wait until the journal's thread has done its work."""
        self._loop._writer.submit(lambda: None).result(PATIENCE_S)

    def free(self) -> None:
        """Let the loop run alone."""
        self._is_free.set()

    def _hold(self) -> None:
        self._is_held.set()
        is_stopping = self._loop._is_stopping.is_set
        # A test that has failed stops the loop without freeing it.
        while not (is_stopping() or self._is_free.wait(0.02)):
            pass
        if not is_stopping():
            self._tick_alone()
