"""A program that runs beside Slicer: started, listened to line by line, and ended.

Slicer's Python is a launcher that starts the real one and passes no signal on, so that to end what
was started is not to end what runs. On POSIX the program gets a session, and so a group, of its
own, in which all that it starts stays. On Windows they are in one job object (`windows_job`).

The end of Slicer does not end them: a running trial survives a crash of Slicer.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.journal.folder import STARTED_BY
from rastrainer.python_environment import clean_environment
from rastrainer.work_progress import Progress, report_line

if sys.platform == "win32":
    from rastrainer.slicer.program.windows_job import WINDOWS_OPTIONS, WindowsJob, endTree

    OPTIONS = WINDOWS_OPTIONS
    ProcessGroup = WindowsJob

    def endProcess(pid: int, hasOwnGroup: bool, isAsked: bool) -> None:  # noqa: ARG001
        """End a process and all that it has started, at once: see `WindowsJob.end`."""
        endTree(pid)

else:
    import signal

    OPTIONS: dict[str, Any] = {"start_new_session": True}
    """Of `subprocess.Popen`."""

    def endProcess(pid: int, hasOwnGroup: bool, isAsked: bool) -> None:
        """End a process that this one has not started.

        Args:
            pid: its number.
            hasOwnGroup: whether `OPTIONS` have started it; then all that it has started ends, too.
            isAsked: whether it is asked to end; otherwise it is killed.

        Raises:
            PermissionError: it is another user's.
        """
        number = signal.SIGTERM if isAsked else signal.SIGKILL
        with contextlib.suppress(ProcessLookupError):
            if hasOwnGroup:
                os.killpg(os.getpgid(pid), number)
            else:
                os.kill(pid, number)

    class PosixProcessGroup:
        """A process started with `OPTIONS`, and all that it starts."""

        def __init__(self, process: subprocess.Popen[str]) -> None:
            self._id = process.pid

        def end(self) -> None:
            """Ask them to end."""
            self._send(signal.SIGTERM)

        def kill(self) -> None:
            """End them at once."""
            self._send(signal.SIGKILL)

        def _send(self, number: int) -> None:
            # Where they have all ended, or (macOS) those that have wait to be noticed.
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._id, number)

    ProcessGroup = PosixProcessGroup


LINES_KEPT = 2000
LONGEST_LINE = 2000
KILL_AFTER_S = 5.0
LAST_OUTPUT_S = 1.0
"""How long to wait for the output of what was killed."""
CLOSING_S = 0.5
"""How long `close` waits for an orderly end: Slicer's user waits for that."""
PERIOD_S = 0.02
SLICER = "Slicer"


class NotStartedError(InputError):
    """A program cannot be started."""


class ChildProcess:
    """A program with its output; only `close` waits, and briefly.

    Attributes:
        arguments: what was started.
    """

    def __init__(
        self, arguments: Sequence[str | Path], environment: Mapping[str, str] | None = None
    ) -> None:
        """Start the program, in the environment of `childEnvironment` unless another is given.

        Raises:
            NotStartedError: it cannot be started.
        """
        self.arguments = [str(argument) for argument in arguments]
        self._lines: deque[str] = deque(maxlen=LINES_KEPT)
        self._killAt: float | None = None
        try:
            self._process = subprocess.Popen(
                self.arguments,
                env=childEnvironment() if environment is None else dict(environment),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                encoding="utf-8",
                errors="replace",
                **OPTIONS,
            )
            self._group = ProcessGroup(self._process)
        except OSError as error:
            raise NotStartedError(
                f"{self.arguments[0]} cannot be started: {error.strerror or error}."
            ) from None
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    @property
    def exitStatus(self) -> int | None:
        """The program's exit status; None while it runs, regardless of what it started."""
        return self._process.poll()

    def poll(self) -> bool:
        """Return whether it is over: it has ended, and so has all that it started.

        To be called again and again, as it ends what the program has left behind, and kills what
        does not end within seconds.
        """
        hasEnded = self._process.poll() is not None
        # What it has started holds the other end of its output.
        if hasEnded and not self._reader.is_alive():
            return True
        if hasEnded:
            self.end()
        if self._killAt is None or time.monotonic() < self._killAt:
            return False
        self._group.kill()
        # A process that has left the group may keep the output open forever.
        return hasEnded and time.monotonic() > self._killAt + LAST_OUTPUT_S

    def takeLines(self) -> list[str]:
        """Return the lines that it has written since the last call."""
        lines = []
        with contextlib.suppress(IndexError):
            while True:
                lines.append(self._lines.popleft())
        return lines

    def end(self) -> None:
        """Ask the program and all that it has started to end, once; see `poll`."""
        if self._killAt is None:
            self._killAt = time.monotonic() + KILL_AFTER_S
            self._group.end()

    def close(self) -> None:
        """End it and all that it has started, in order where that takes half a second at most."""
        self.end()
        self._reader.join(CLOSING_S)
        if not self.poll():
            self._group.kill()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(LAST_OUTPUT_S)

    def abandon(self) -> None:
        """Ask it to end, and make sure that it does, in the background."""
        self.end()
        threading.Thread(target=self._finish, daemon=True).start()

    def _finish(self) -> None:
        while not self.poll():
            time.sleep(PERIOD_S)

    def _read(self) -> None:
        assert self._process.stdout is not None
        with self._process.stdout as output:
            while line := output.readline(LONGEST_LINE):
                self._lines.append(line.rstrip())


def childEnvironment() -> dict[str, str]:
    """Return the environment of every program that Slicer starts: none of Slicer's folders."""
    # Lines are to arrive while the program runs.
    added = {"PYTHONUNBUFFERED": "1", STARTED_BY: SLICER}
    return {**clean_environment(os.environ), **added}


@dataclass(frozen=True)
class ChildResult:
    """The outcome of a program that was run to its end.

    Attributes:
        exitStatus: its exit status; None where it could not be ended.
        lastLine: the last line it has written that is not empty; empty where it wrote nothing.
        warnings: sentences it has printed by `print_warning`.
    """

    exitStatus: int | None
    lastLine: str
    warnings: tuple[str, ...]


def runChild(command: Sequence[str | Path], progress: Progress, firstStep: str = "") -> ChildResult:
    """Run a program to its end.

    Args:
        command: its words.
        progress: called many times a second with the step and share that the program has printed
            last (see `print_progress`); it may let the application draw, and may raise to break
            the program off, which then ends soon.
        firstStep: passed to `progress` until the program prints a step.

    Raises:
        NotStartedError: it cannot be started.
    """
    child = ChildProcess(command)
    step, lastLine = (firstStep, 0.0), ""
    warnings: list[str] = []

    def noteStep(name: str, share: float) -> None:
        nonlocal step
        step = name, share

    try:
        isOver = False
        while not isOver:
            isOver = child.poll()
            for line in child.takeLines():
                report_line(line, noteStep, warnings.append)
                lastLine = line or lastLine
            progress(*step)
            if not isOver:
                time.sleep(PERIOD_S)
    except BaseException:
        child.abandon()
        raise
    return ChildResult(child.exitStatus, lastLine, tuple(warnings))
