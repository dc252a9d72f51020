"""Processes: displays, priorities, and ending by a signal."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import signal
import subprocess
import sys
from collections.abc import Iterator

BELOW_NORMAL = getattr(subprocess, "BELOW_NORMAL_PRIORITY_CLASS", 0)
"""Windows' flag of a process of low priority; elsewhere such a process raises its niceness."""

_log = logging.getLogger(__name__)


def has_display() -> bool:
    names = ("DISPLAY", "WAYLAND_DISPLAY")
    return not sys.platform.startswith("linux") or any(map(os.environ.get, names))


@contextlib.contextmanager
def stop_on_signals(stop: asyncio.Event) -> Iterator[None]:
    """Set the event on SIGTERM, on Ctrl-C and when the terminal is closed."""
    loop = asyncio.get_running_loop()

    def end(name: str) -> None:
        _log.info("The simulator ends by %s.", name)
        stop.set()

    def request_stop(number: int, *_frame: object) -> None:
        loop.call_soon_threadsafe(end, signal.Signals(number).name)

    # Not by the event loop's own means, which Windows lacks.
    numbers = [signal.SIGINT, signal.SIGTERM]
    hang_up = getattr(signal, "SIGHUP", None)
    # A program started by nohup should outlive the terminal.
    if hang_up is not None and signal.getsignal(hang_up) is not signal.SIG_IGN:
        numbers.append(hang_up)
    before = {number: signal.signal(number, request_stop) for number in numbers}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
