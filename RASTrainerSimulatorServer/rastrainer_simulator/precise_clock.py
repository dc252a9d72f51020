"""Sleep until a moment of the monotonic clock, to a fraction of a millisecond."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Iterator

SWITCH_INTERVAL_S = 0.0001
"""How long another Python thread may keep the interpreter once the control loop is due.

Python's own 5 ms would let one busy thread make every second tick late, and with 0.5 ms two busy
threads in a row make one in fifty late.
"""


def sleep_until(moment: float) -> None:
    """Return at `moment` (s, `time.monotonic`), or at once if it has passed."""
    remaining = moment - time.monotonic()
    if remaining > 0.0:
        time.sleep(remaining)


@contextlib.contextmanager
def precise_timing() -> Iterator[None]:
    """Let this process wake up on time; everything is as before when it ends."""
    interval = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_INTERVAL_S)
    try:
        with _fine_timer():
            yield
    finally:
        sys.setswitchinterval(interval)


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
