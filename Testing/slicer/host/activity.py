"""Activity of a module while nothing happens: it costs Slicer time, or a whole repaint."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from PySide6 import QtCore, QtWidgets

CLOCK_MS = 100
_DRAWN = (QtCore.QEvent.Type.Paint, QtCore.QEvent.Type.LayoutRequest)
_watching: list[ActivityWatch] = []


class ActivityWatch(QtCore.QObject):
    """Counts in a `with` statement.

    `writes` are assignments to widgets, as `name.property` or `name.setProperty`, also of the same
    value; `drawn` names the widgets that were painted, or got another layout; `ticks` is how often
    timers of the module were over, `busy_s` its processor time for timers and widgets, and `clock`
    the periods of `CLOCK_MS` that Qt has counted, however busy the machine is.
    """

    def __init__(self) -> None:
        super().__init__()
        self.writes: list[str] = []
        self.drawn: list[str] = []
        self.ticks = self.clock = 0
        self.busy_s = 0.0
        self._timer = QtCore.QTimer()
        self._timer.setInterval(CLOCK_MS)
        self._timer.timeout.connect(self._count)

    def __enter__(self) -> ActivityWatch:
        _watching.append(self)
        QtWidgets.QApplication.instance().installEventFilter(self)
        self._timer.start()
        return self

    def __exit__(self, *_exception: object) -> None:
        self._timer.stop()
        QtWidgets.QApplication.instance().removeEventFilter(self)
        _watching.remove(self)

    def eventFilter(self, watched: QtCore.QObject, event: QtCore.QEvent) -> bool:
        if event.type() in _DRAWN and isinstance(watched, QtWidgets.QWidget):
            self.drawn.append(watched.objectName())
        return False

    def _count(self) -> None:
        self.clock += 1


def note_write(written: QtCore.QObject, name: str) -> None:
    """Note that a property of an object was assigned, or one of its setters called."""
    for watch in _watching:
        if isinstance(written, QtWidgets.QWidget):
            watch.writes.append(f"{written.objectName()}.{name}")


def run_slot(function: Callable[..., Any], arguments: Sequence[Any], is_tick: bool) -> None:
    """Call a function of the module for a signal, perhaps from a timer."""
    begin = time.thread_time()
    try:
        function(*arguments)
    finally:
        for watch in _watching:
            watch.ticks += is_tick
            watch.busy_s += time.thread_time() - begin
