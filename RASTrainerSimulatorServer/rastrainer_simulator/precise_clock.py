"""Sleep until a moment of the monotonic clock, to a fraction of a millisecond."""

from __future__ import annotations

import contextlib
import os
import sys
import time
from collections.abc import Iterator

SWITCH_INTERVAL_S = 0.0001
"""How long another Python thread may keep the interpreter once the control loop is due.

Python's own 5 ms would let one busy thread make every second tick late, and with 0.5 ms two busy
threads in a row make one in fifty late.
"""

_TIME_CRITICAL = 15


def sleep_until(moment: float) -> None:
    """Return at `moment` (s, `time.monotonic`), or at once if it has passed."""
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
        with _fine_timer(), _first_in_line() if is_first_in_line else contextlib.nullcontext():
            yield
    finally:
        sys.setswitchinterval(interval)


@contextlib.contextmanager
def _first_in_line() -> Iterator[None]:
    """Ask for real-time priority; Linux grants it to root and where `ulimit -r` is above 0."""
    if sys.platform == "win32":
        with _thread_priority(_TIME_CRITICAL):
            yield
        return
    if not hasattr(os, "SCHED_FIFO"):
        yield
        return
    # Threads that it starts, such as the journal's, stay ordinary.
    flag = os.SCHED_RESET_ON_FORK
    policy, parameters = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO | flag, os.sched_param(1))
    except PermissionError:
        yield
        return
    try:
        yield
    finally:
        # Whoever is not root may not take the flag back.
        os.sched_setscheduler(0, policy | flag, parameters)


@contextlib.contextmanager
def _thread_priority(priority: int) -> Iterator[None]:
    """Set the priority of this thread on Windows, which permits it to everyone."""
    import ctypes

    kernel = ctypes.windll.kernel32
    kernel.GetCurrentThread.restype = ctypes.c_void_p
    thread = ctypes.c_void_p(kernel.GetCurrentThread())
    before = kernel.GetThreadPriority(thread)
    kernel.SetThreadPriority(thread, priority)
    try:
        yield
    finally:
        kernel.SetThreadPriority(thread, before)


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
