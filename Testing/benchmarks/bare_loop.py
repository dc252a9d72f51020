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
    """A process of its own while the `with` statement lasts; then `punctuality` tells of it."""

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._ours, theirs = context.Pipe()
        self._process = context.Process(target=_loop, args=(theirs,), daemon=True)
        self.punctuality: Punctuality | None = None

    def __enter__(self) -> BareLoop:
        self._process.start()
        self._ours.recv()
        return self

    def __exit__(self, *_exception: object) -> None:
        self._ours.send("stop")
        late = np.frombuffer(self._ours.recv(), dtype=np.uint8)
        self._process.join()
        whole = len(late) - len(late) % TICKS_PER_S
        shares = 100.0 * (1.0 - late[:whole].reshape(-1, TICKS_PER_S).mean(axis=1))
        self.punctuality = Punctuality(shares, float(1.0 - late.mean()), len(late))


def _loop(told: Connection) -> None:
    is_late = bytearray()
    told.send("ready")
    with precise_timing(is_first_in_line=True):
        due = time.monotonic()
        while not told.poll():
            due += TICK_S
            sleep_until(due)
            is_late.append(time.monotonic() - due > ON_TIME_S)
    told.send(bytes(is_late))
