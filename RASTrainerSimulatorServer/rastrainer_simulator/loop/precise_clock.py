"""Keep the control loop punctual: sleeping, priority, and how punctual it has been."""

from __future__ import annotations

import contextlib
import os
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

SWITCH_INTERVAL_S = 0.0001
"""How long another Python thread may keep the interpreter once the control loop is due.

Python's own 5 ms would let one busy thread make every second tick late, and with 0.5 ms two busy
threads in a row make one in fifty late.
"""

FIRST, SECOND = 2, 1
"""Real-time priorities of Linux: of the control loop, and of the threads that it waits for."""

_WINDOWS_PRIORITY = {FIRST: 15, SECOND: 2}  # TIME_CRITICAL, HIGHEST


def sleep_until(moment: float) -> None:
    """Return at `moment` (s, `time.monotonic`), or immediately if it has passed."""
    remaining = moment - time.monotonic()
    if remaining > 0.0:
        time.sleep(remaining)


@contextlib.contextmanager
def precise_timing(is_first_in_line: bool) -> Iterator[None]:
    """Let this process wake up on time; everything is as before when it ends.

    With `is_first_in_line` the thread runs before all ordinary ones, if the system permits it. That
    is for a thread that sleeps between its ticks: one that never sleeps would leave them nothing.
    """
    interval = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_INTERVAL_S)
    try:
        with _fine_timer(), _in_line(FIRST) if is_first_in_line else contextlib.nullcontext():
            yield
    finally:
        sys.setswitchinterval(interval)


def raise_thread_priority() -> None:
    """Let this thread run before all ordinary ones from now on, but after the control loop.

    It is for the threads that share the interpreter with the loop in every tick. One that is put
    aside for another program while it holds the interpreter makes the loop wait for both, whatever
    the loop's own priority (priority inversion). Nothing happens where the system does not permit
    it; processes and threads that the thread starts stay ordinary.
    """
    if sys.platform == "win32":
        _set_windows_priority(_WINDOWS_PRIORITY[SECOND])
    elif hasattr(os, "SCHED_FIFO"):
        set_real_time(SECOND)


def is_real_time_permitted() -> bool:
    """Return whether a system with `SCHED_FIFO` lets the loop run before ordinary threads."""
    # Tried in a thread that ends with it, so that nothing has to be undone.
    with ThreadPoolExecutor(max_workers=1) as pool:
        return pool.submit(set_real_time, FIRST).result()


@contextlib.contextmanager
def _in_line(priority: int) -> Iterator[None]:
    """Request real-time priority; Linux grants it to root and up to the limit of `ulimit -r`."""
    if sys.platform == "win32":
        before = _set_windows_priority(_WINDOWS_PRIORITY[priority])
        try:
            yield
        finally:
            _set_windows_priority(before)
        return
    if not hasattr(os, "SCHED_FIFO"):
        yield
        return
    policy, parameters = os.sched_getscheduler(0), os.sched_getparam(0)
    if not set_real_time(priority):
        yield
        return
    try:
        yield
    finally:
        # Only root may clear the flag again.
        os.sched_setscheduler(0, policy | os.SCHED_RESET_ON_FORK, parameters)


def set_real_time(priority: int) -> bool:
    """Set the priority of this thread; return whether the system permits it."""
    # What the thread starts, such as the window, stays ordinary.
    policy = os.SCHED_FIFO | os.SCHED_RESET_ON_FORK
    try:
        os.sched_setscheduler(0, policy, os.sched_param(priority))
    except PermissionError:
        return False
    return True


if sys.platform == "win32":

    def _set_windows_priority(priority: int) -> int:
        """Set this thread's priority, which Windows permits to everyone; return the former one."""
        import ctypes

        kernel = ctypes.windll.kernel32
        kernel.GetCurrentThread.restype = ctypes.c_void_p
        thread = ctypes.c_void_p(kernel.GetCurrentThread())
        before = kernel.GetThreadPriority(thread)
        kernel.SetThreadPriority(thread, priority)
        return before


@contextlib.contextmanager
def _fine_timer() -> Iterator[None]:
    """Ask Windows for timers of 1 ms; its default of 15.6 ms is four ticks."""
    if sys.platform != "win32":
        yield
        return
    import ctypes

    ctypes.windll.winmm.timeBeginPeriod(1)
    try:
        yield
    finally:
        ctypes.windll.winmm.timeEndPeriod(1)


LATE_S = 0.001
"""A tick that starts this much after its time counts as late."""


@dataclass(frozen=True)
class LoopStatistics:
    """Since the loop was started.

    Attributes:
        ticks: carried out.
        late: of these, started more than 1 ms after their time.
        skipped: never carried out, because the loop had fallen too far behind: the simulated
            clock has lost them.
        worst_delay_s: the longest time by which a tick was late.
    """

    ticks: int = 0
    late: int = 0
    skipped: int = 0
    worst_delay_s: float = 0.0


class Punctuality:
    """Counts for `LoopStatistics`, in the control loop's thread."""

    def __init__(self) -> None:
        self._ticks = 0
        self._late = 0
        self._skipped = 0
        self._worst = 0.0

    def count(self, delay: float) -> None:
        """Count a tick that starts `delay` seconds after its time."""
        self._ticks += 1
        if delay > LATE_S:
            self._late += 1
        if delay > self._worst:
            self._worst = delay

    def skip(self, ticks: int) -> None:
        """Count ticks that are given up."""
        self._skipped += ticks

    def statistics(self) -> LoopStatistics:
        """Return the counts."""
        return LoopStatistics(self._ticks, self._late, self._skipped, self._worst)
