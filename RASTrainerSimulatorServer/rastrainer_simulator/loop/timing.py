"""Time: a punctual control loop, and how often something may happen and how long it may take."""

from __future__ import annotations

import contextlib
import math
import os
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Annotated, Any

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
    """Let this process wake up on time until the end of the context.

    With `is_first_in_line` this thread runs before all ordinary threads from now on, if the system
    permits it; it must sleep between its ticks, or they would never run.
    """
    interval = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_INTERVAL_S)
    if is_first_in_line:
        raise_thread_priority(FIRST)
    # Windows has timers of 15.6 ms by default, which is four ticks.
    if sys.platform == "win32":
        import ctypes

        ctypes.windll.winmm.timeBeginPeriod(1)
    try:
        yield
    finally:
        sys.setswitchinterval(interval)
        if sys.platform == "win32":
            ctypes.windll.winmm.timeEndPeriod(1)


def raise_thread_priority(priority: int = SECOND) -> None:
    """Let this thread run before all ordinary threads from now on, but after the control loop.

    It is for the threads that share the interpreter with the loop in every tick: if such a thread
    is put aside while it holds the interpreter, the loop waits, too (priority inversion). Windows
    permits it to everyone, Linux to root and up to the limit of `ulimit -r`; else nothing happens.
    """
    if sys.platform == "win32":
        import ctypes

        kernel = ctypes.windll.kernel32
        kernel.GetCurrentThread.restype = ctypes.c_void_p
        thread = ctypes.c_void_p(kernel.GetCurrentThread())
        kernel.SetThreadPriority(thread, _WINDOWS_PRIORITY[priority])
    elif hasattr(os, "SCHED_FIFO"):
        # Processes and threads that the thread starts, such as the window, stay ordinary.
        policy = os.SCHED_FIFO | os.SCHED_RESET_ON_FORK
        with contextlib.suppress(PermissionError):
            os.sched_setscheduler(0, policy, os.sched_param(priority))


LATE_S = 0.001
"""A tick that starts this much after its time counts as late."""


@dataclass
class LoopStatistics:
    """Counts of ticks since the loop was started.

    Late ticks started more than 1 ms after their time. Skipped ticks were never carried out,
    because the loop had fallen too far behind: the simulated clock has lost them.
    """

    ticks: int = 0
    late: int = 0
    skipped: int = 0
    worst_delay_s: float = 0.0

    def count(self, delay: float) -> None:
        self.ticks += 1
        if delay > LATE_S:
            self.late += 1
        if delay > self.worst_delay_s:
            self.worst_delay_s = delay


class RateLimit:
    """Allows `per_s` times a second on average, and `at_once` after a pause (a token bucket)."""

    def __init__(self, per_s: float, at_once: float) -> None:
        self._per_s = per_s
        self._at_once = at_once
        self._left = at_once
        self._since = 0.0

    def allows(self, now: float) -> bool:
        """Count one more at the time `now` (s); return whether it is within the limit."""
        self._left = min(self._at_once, self._left + (now - self._since) * self._per_s)
        self._since = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


def above_zero(most: float, is_whole: bool = False) -> Callable[[Any], float]:
    """Accept a number, or a whole number, above 0: a limit of nothing is a mistake."""
    words = f"a {'whole ' if is_whole else ''}number above 0, up to {most}"

    def check(value: Any) -> float:
        if type(value) not in ((int,) if is_whole else (int, float)) or not 0 < value <= most:
            raise ValueError(words)
        return value

    return check


@dataclass(frozen=True)
class TrialLimits:
    """Trials that may be started on average, by simulated time, and at once after a pause.

    Each makes a journal, and its start takes as long as several ticks.
    """

    starts_per_s: Annotated[float, above_zero(2**20)] = 0.2
    starts_at_once: Annotated[int, above_zero(2**16, is_whole=True)] = 4


_TOLERANCE_S = 1e-9
_SAVED_AT_MOST_S = 0.02


class Pacer:
    """Times events at `hz` per second; none at 0 Hz."""

    def __init__(self, hz: float):
        self._period = 1.0 / hz if hz > 0 else math.inf
        self.next = -math.inf if hz > 0 else math.inf

    def is_due(self, now: float) -> bool:
        """Return whether the next event is due, and plan the following event.

        The rate holds on average although `now` comes in ticks; missed events are dropped.
        """
        has_restarted = now + 1.5 * self._period < self.next < math.inf
        if now < self.next - _TOLERANCE_S and not has_restarted:
            return False
        self.next += self._period
        if not now < self.next <= now + self._period:
            self.next = now + self._period
        return True


class ReadingBudget:
    """Time to spend on a client's bytes: it grows steadily, and a debt makes the client wait.

    A client that sends much is read later and never delays the control loop. A new client has
    nothing saved, so that connecting again gains nothing.
    """

    def __init__(self, now: float):
        self._saved = 0.0
        self._since = now

    def charge(self, spent: float, share: float, now: float) -> float:
        """Take `spent` seconds off a budget that grows by `share` of the time.

        Returns how long nothing more may be read, in s.
        """
        earned = self._saved + share * (now - self._since)
        self._saved = min(earned, _SAVED_AT_MOST_S) - spent
        self._since = now
        return max(0.0, -self._saved / share)
