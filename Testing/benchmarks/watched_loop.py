"""How punctual a running simulator is under load, compared with a bare loop.

The bare loop does nothing, as often and as urgently as the simulator's: where other programs, or
other guests of a virtual machine's host, take the processor away, no loop is on time.
"""

from __future__ import annotations

import multiprocessing
import os
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection

import numpy as np

from rastrainer.igtl.client import Client
from rastrainer_simulator.loop.timing import (
    FIRST,
    LoopStatistics,
    precise_timing,
    raise_thread_priority,
    sleep_until,
)
from Testing.benchmarks.loop_health import Punctuality, next_health, punctuality, undisturbed

TICK_S = 0.004
ON_TIME_S = 0.001
TICKS_PER_S = 250
MAX_PROCESSORS = 8


class BareLoop:
    """A process for each of the machine's processors while the `with` statement lasts.

    A load on one processor may leave the others alone, and ours runs on any of them. After
    the statement `punctuality` covers all together, and `was_never_late` any stretch of time.
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
        """Return whether no tick was late between two moments of `time.monotonic`, s."""
        first, last = (max(0, round((moment - self._start) / TICK_S)) for moment in (start, end))
        return not self._late[:, first : last + 1].any()


def _processors() -> list[int | None]:
    """Return the processors that may be used here; [None] where the system does not report them."""
    if not hasattr(os, "sched_getaffinity"):
        return [None]
    return sorted(os.sched_getaffinity(0))[:MAX_PROCESSORS]


def _loop(pipe: Connection, processor: int | None) -> None:
    if processor is not None:
        os.sched_setaffinity(0, {processor})
    is_late = bytearray()
    with precise_timing(is_first_in_line=True):
        if hasattr(os, "SCHED_FIFO"):
            raise_thread_priority(FIRST + 1)  # It waits for the machine alone, not for the loop.
        pipe.send("ready")
        due = pipe.recv()
        while not pipe.poll():
            due += TICK_S
            sleep_until(due)
            is_late.append(time.monotonic() - due > ON_TIME_S)
    pipe.send(bytes(is_late))


class WatchedLoop:
    """Listens to a simulator's heartbeats while the `with` statement lasts.

    After it, from the first heartbeat to the last:

    Attributes:
        measured: how punctual the simulator's loop was.
        bare: the same of a loop on each processor that does nothing: none can do better there and
            then.
        undisturbed: of the simulator's, in those seconds in which none of these was late; None if
            there was no such second.
    """

    def __init__(self, client: Client) -> None:
        self.measured: Punctuality | None = None
        self.bare: Punctuality | None = None
        self.undisturbed: Punctuality | None = None
        self._client = client
        self._bare_loop = BareLoop()
        self._listener = ThreadPoolExecutor(1)
        self._is_over = threading.Event()

    def __enter__(self) -> WatchedLoop:
        self._bare_loop.__enter__()
        self._heard = self._listener.submit(self._listen)
        return self

    def __exit__(self, *exception: object) -> None:
        self._is_over.set()
        self._listener.shutdown()
        self._bare_loop.__exit__(*exception)
        healths = self._heard.result()
        self.measured = punctuality([health for _, health in healths])
        self.bare = self._bare_loop.punctuality
        self.undisturbed = undisturbed(healths, self._bare_loop.was_never_late)

    def _listen(self) -> list[tuple[float, LoopStatistics]]:
        healths = [self._next_beat()]
        while not self._is_over.is_set():
            healths.append(self._next_beat())
        return healths

    def _next_beat(self) -> tuple[float, LoopStatistics]:
        health = next_health(self._client)
        return time.monotonic(), health
