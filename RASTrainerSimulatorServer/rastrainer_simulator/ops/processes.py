"""Processes: our environment and that of children, ending by a signal, the window's process."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

from rastrainer.python_environment import python_command

VIEW_KEY_VARIABLE = "RASTRAINER_VIEW_KEY"
"""Environment variable with a key of the views, shared by a simulator and its window."""
BELOW_NORMAL = getattr(subprocess, "BELOW_NORMAL_PRIORITY_CLASS", 0)
"""Windows' flag of a process of low priority; elsewhere such a process raises its niceness."""
ENDING_S = 3.0
GONE = (
    "continues without its window, which ended with status {status}: open another with `rastrainer "
    "window --connect {url} --code` and the pairing code"
)

_log = logging.getLogger(__name__)


def environment_without_secrets() -> dict[str, str]:
    """Return the environment without the views' key, which other processes must not know."""
    return {name: value for name, value in os.environ.items() if name != VIEW_KEY_VARIABLE}


def has_display() -> bool:
    """Return whether a window can be seen; SDL would run without a display, and show nothing."""
    names = ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER", "SDL_VIDEO_DRIVER")
    return not sys.platform.startswith("linux") or any(map(os.environ.get, names))


class DesktopProcess:
    """Runs the desktop window of one simulator."""

    def __init__(self, url: str, key: str, logs: Path):
        """`url` is that of the views, `key` is valid for them; the window logs to `logs`."""
        self._url = url
        self._key = key
        self._logs = logs
        self._process: asyncio.subprocess.Process | None = None

    async def run(self, on_closed: Callable[[], None], announce: Callable[[str], None]) -> None:
        """Open the window and wait for its end.

        `on_closed` is called if its user has closed it. If it ended in any other way the
        simulator stays, with the trial that is running; `announce` says how to come back.
        """
        options = ("--connect", self._url, "--log-folder", str(self._logs))
        command = python_command("rastrainer_simulator.cli.main", "window", *options)
        environment = {**os.environ, VIEW_KEY_VARIABLE: self._key}
        self._process = await asyncio.create_subprocess_exec(*command, env=environment)
        status = await self._process.wait()
        if status == 0:
            on_closed()
        else:
            announce(GONE.format(status=status, url=self._url))

    async def close(self) -> None:
        """Close the window if it is still open."""
        process = self._process
        if process is None or process.returncode is not None:
            return
        with contextlib.suppress(ProcessLookupError):
            process.terminate()
        try:
            await asyncio.wait_for(process.wait(), ENDING_S)
        except asyncio.TimeoutError:
            process.kill()
            await process.wait()


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
