"""Qt's events as Slicer lets them pass: the main thread keeps Python's lock meanwhile.

Slicer starts PythonQt without its support of threads, so nothing gives the lock away while Qt waits
for events. A thread of Python runs only while the main thread runs Python too, or waits in a call
of Python's that gives the lock away, such as `time.sleep` or `Thread.join`. PySide gives it away.
"""

from __future__ import annotations

import ctypes
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

import PySide6
from PySide6 import QtCore, QtWidgets

_PROCESS_EVENTS = "_ZN16QCoreApplication13processEventsE6QFlagsIN10QEventLoop17ProcessEventsFlagEE"
_WAIT_US = 2000


def process_events_keeping_lock() -> None:
    """Let Qt process its events; where Qt's library is not Linux's, PySide does it."""
    if sys.platform != "linux":
        QtWidgets.QApplication.processEvents()
        return
    # `PyDLL`, in contrast to `CDLL`, calls without giving the lock away.
    library = next((Path(PySide6.__file__).parent / "Qt" / "lib").glob("libQt6Core.so.6"))
    getattr(ctypes.PyDLL(str(library)), _PROCESS_EVENTS)(0)


def wait_keeping_lock() -> None:
    """Wait 2 ms for the next event."""
    if sys.platform == "linux":
        ctypes.PyDLL(None).usleep(_WAIT_US)


PLENTY = 1 << 40


def lend_references() -> None:
    """Give None and the truth values more references than a test session can drop."""
    if sys.version_info < (3, 12):
        for value in (None, True, False):
            ctypes.c_ssize_t.from_address(id(value)).value += PLENTY


TICK_MS = 5
LOOK_AFTER_S = 0.03
"""A stall of this length is examined: what the main thread runs then is recorded."""


@dataclass(frozen=True)
class Stall:
    """A time without a turn of the loop, in which the innermost lines of ours `ran`.

    `own_s` is without what the main thread waited for a processor, which other programs had.
    """

    seconds: float
    own_s: float
    ran: str


class StallWatch:
    """Measures in a `with` statement; the loop must turn meanwhile.

    `stalls` has each gap between two turns that was longer than a look. `longest_s` and
    `longest_own_s` are of all gaps.
    """

    def __init__(self) -> None:
        self.stalls: list[Stall] = []
        self.longest_s = self.longest_own_s = 0.0
        self._main = threading.get_ident()
        self._last, self._waited_s = time.perf_counter(), waited_for_processor_s()
        self._ran = ""
        self._ends = threading.Event()
        self._timer = QtCore.QTimer()
        self._timer.setTimerType(QtCore.Qt.TimerType.PreciseTimer)
        self._timer.setInterval(TICK_MS)
        self._timer.timeout.connect(self._tick)
        self._sampler = threading.Thread(target=self._look, daemon=True)

    def __enter__(self) -> StallWatch:
        self._last, self._waited_s = time.perf_counter(), waited_for_processor_s()
        self._timer.start()
        self._sampler.start()
        return self

    def __exit__(self, *_exception: object) -> None:
        self._tick()
        self._timer.stop()
        self._ends.set()
        self._sampler.join()

    def _tick(self) -> None:
        now, waited_s = time.perf_counter(), waited_for_processor_s()
        seconds, self._last = now - self._last, now
        own_s, self._waited_s = seconds - (waited_s - self._waited_s), waited_s
        self.longest_s = max(self.longest_s, seconds)
        self.longest_own_s = max(self.longest_own_s, own_s)
        if seconds > LOOK_AFTER_S:
            self.stalls.append(Stall(seconds, own_s, self._ran))
        self._ran = ""

    def _look(self) -> None:
        while not self._ends.wait(TICK_MS / 1000):
            if not self._ran and time.perf_counter() - self._last > LOOK_AFTER_S:
                self._ran = " < ".join(_ours(sys._current_frames().get(self._main))[:4])


def waited_for_processor_s() -> float:
    """Return how long this thread could have run so far, but other programs had the processors.

    Known on Linux only; 0 elsewhere.
    """
    path = Path(f"/proc/self/task/{threading.get_native_id()}/schedstat")
    return int(path.read_text().split()[1]) / 1e9 if path.exists() else 0.0


def _ours(frame: FrameType | None) -> list[str]:
    """Return our functions in a stack, the innermost first.

    Without reading any file: holding a frame for longer would keep painters alive.
    """
    names = []
    while frame is not None:
        if "rastrainer" in frame.f_code.co_filename.lower():
            names.append(f"{frame.f_code.co_name}:{frame.f_lineno}")
        frame = frame.f_back
    return names
