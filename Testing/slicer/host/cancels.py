"""A user who presses Cancel while something is under way."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from PySide6 import QtCore

from Testing.slicer.host.host import Host

PERIOD_MS = 5


@contextmanager
def cancels(host: Host, button: str, when: Callable[[], bool] = lambda: True) -> Iterator[None]:
    """Press a button within the context when it says Cancel and `when()` is true."""
    timer = QtCore.QTimer()
    timer.setInterval(PERIOD_MS)

    def press() -> None:
        if host.text(button) == "Cancel" and when():
            timer.stop()
            host.press(button)

    timer.timeout.connect(press)
    timer.start()
    try:
        yield
        if timer.isActive():
            raise AssertionError(f"{button} was never to be pressed as Cancel.")
    finally:
        timer.stop()
