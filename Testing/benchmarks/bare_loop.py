"""What the machine itself allows: a loop that does nothing, as often and as urgently as ours.

Where others take the processor away, such as the other guests of a virtual machine's host, no loop
is on time. So it runs beside the simulator, as what the simulator's punctuality is compared with.
"""

from __future__ import annotations

import multiprocessing
import time
from multiprocessing.connection import Connection

import numpy as np

from rastrainer_simulator.precise_clock import precise_timing, sleep_until
from Testing.benchmarks.loop_health import Punctuality

TICK_S = 0.004
ON_TIME_S = 0.001
TICKS_PER_S = 250


class BareLoop:
    """A process of its own while the `with` statement lasts.

    After it `punctuality` tells of it, and `was_never_late` of any stretch of time.
    """

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._ours, theirs = context.Pipe()
        self._process = context.Process(target=_loop, args=(theirs,), daemon=True)
        self.punctuality: Punctuality | None = None
        self._start = 0.0
        self._late = np.empty(0, dtype=np.uint8)

    def __enter__(self) -> BareLoop:
        self._process.start()
        self._start = self._ours.recv()
        return self

    def __exit__(self, *_exception: object) -> None:
        self._ours.send("stop")
        self._late = late = np.frombuffer(self._ours.recv(), dtype=np.uint8)
        self._process.join()
        whole = len(late) - len(late) % TICKS_PER_S
        shares = 100.0 * (1.0 - late[:whole].reshape(-1, TICKS_PER_S).mean(axis=1))
        self.punctuality = Punctuality(shares, float(1.0 - late.mean()), len(late))

    def was_never_late(self, start: float, end: float) -> bool:
        """Tell whether no tick was late between two moments of `time.monotonic`, s."""
        first, last = (max(0, round((moment - self._start) / TICK_S)) for moment in (start, end))
        return not self._late[first : last + 1].any()


def _loop(told: Connection) -> None:
    is_late = bytearray()
    with precise_timing(is_first_in_line=True):
        due = time.monotonic()
        told.send(due)
        while not told.poll():
            due += TICK_S
            sleep_until(due)
            is_late.append(time.monotonic() - due > ON_TIME_S)
    told.send(bytes(is_late))
