"""Qt's events as Slicer lets them pass: the main thread keeps Python's lock meanwhile.

Slicer starts PythonQt without its support of threads, so nothing gives the lock away while Qt waits
for events. A thread of Python runs only while the main thread runs Python too, or waits in a call
of Python's that gives the lock away, such as `time.sleep` or `Thread.join`. PySide gives it away.
"""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path

import PySide6
from PySide6 import QtWidgets

_PROCESS_EVENTS = "_ZN16QCoreApplication13processEventsE6QFlagsIN10QEventLoop17ProcessEventsFlagEE"
_WAIT_US = 2000


def process_events_keeping_lock() -> None:
    """Let Qt do what is due; where Qt's library is none of Linux, PySide does it."""
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
