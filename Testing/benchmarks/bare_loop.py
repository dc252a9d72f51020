"""What the machine itself allows: a loop that does nothing, as often and as urgently as ours.

Where others take the processor away, such as the other guests of a virtual machine's host, no loop
is on time. So it runs beside the simulator, as what the simulator's punctuality is compared with.
"""

from __future__ import annotations

import multiprocessing
import os
import time
from multiprocessing.connection import Connection

import numpy as np

from rastrainer_simulator.loop.precise_clock import (
    FIRST,
    precise_timing,
    set_real_time,
    sleep_until,
)
from Testing.benchmarks.loop_health import Punctuality

TICK_S = 0.004
ON_TIME_S = 0.001
TICKS_PER_S = 250
MOST_PROCESSORS = 8


class BareLoop:
    """A process for each of the machine's processors while the `with` statement lasts.

    What takes one processor away may leave the others alone, and ours runs on any of them. After
    the statement `punctuality` tells of all together, and `was_never_late` of any stretch of time.
    """

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._loops = []
        for processor in _processors():
            ours, theirs = context.Pipe()
            process = context.Process(target=_loop, args=(theirs, processor), daemon=True)
            self._loops.append((process, ours))
        self.punctuality: Punctuality | None = None
        self._start = 0.0
        self._late = np.empty((0, 0), dtype=np.uint8)

    def __enter__(self) -> BareLoop:
        for process, _ours in self._loops:
            process.start()
        for _process, ours in self._loops:
            ours.recv()
        self._start = time.monotonic() + TICK_S
        for _process, ours in self._loops:
            ours.send(self._start)
        return self

    def __exit__(self, *_exception: object) -> None:
        for _process, ours in self._loops:
            ours.send("stop")
        late = [np.frombuffer(ours.recv(), dtype=np.uint8) for _process, ours in self._loops]
        for process, _ours in self._loops:
            process.join()
        ticks = min(len(each) for each in late)
        self._late = np.array([each[:ticks] for each in late])
        whole = ticks - ticks % TICKS_PER_S
        seconds = self._late[:, :whole].reshape(len(late), -1, TICKS_PER_S)
        shares = 100.0 * (1.0 - seconds.mean(axis=(0, 2)))
        self.punctuality = Punctuality(shares, float(1.0 - self._late.mean()), ticks)

    def was_never_late(self, start: float, end: float) -> bool:
        """Tell whether no tick was late between two moments of `time.monotonic`, s."""
        first, last = (max(0, round((moment - self._start) / TICK_S)) for moment in (start, end))
        return not self._late[:, first : last + 1].any()


def _processors() -> list[int | None]:
    """Return the processors that may be used here; [None] where the system does not tell."""
    if not hasattr(os, "sched_getaffinity"):
        return [None]
    return sorted(os.sched_getaffinity(0))[:MOST_PROCESSORS]


def _loop(told: Connection, processor: int | None) -> None:
    if processor is not None:
        os.sched_setaffinity(0, {processor})
    is_late = bytearray()
    with precise_timing(is_first_in_line=True):
        if hasattr(os, "SCHED_FIFO"):
            set_real_time(FIRST + 1)  # To wait for the machine alone, not for the loop beside it.
        told.send("ready")
        due = told.recv()
        while not told.poll():
            due += TICK_S
            sleep_until(due)
            is_late.append(time.monotonic() - due > ON_TIME_S)
    told.send(bytes(is_late))
