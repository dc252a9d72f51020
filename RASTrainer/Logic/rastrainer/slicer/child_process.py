"""A program that runs beside Slicer: started, listened to line by line, and ended."""

from __future__ import annotations

import contextlib
import os
import subprocess
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from rastrainer.clean_environment import clean_environment
from rastrainer.errors import InputError
from rastrainer.journal.folder_holder import STARTED_BY
from rastrainer.slicer.process_group import OPTIONS, ProcessGroup

LINES_KEPT = 2000
LONGEST_LINE = 2000
KILL_AFTER_S = 5.0
LAST_WORDS_S = 1.0
"""How long the output of what was killed is waited for."""
CLOSING_S = 0.5
"""How long `close` lets it end in order: Slicer's user waits for that."""
PERIOD_S = 0.02
SLICER = "Slicer"


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
            InputError: it cannot be started.
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
        except OSError as error:
            raise InputError(
                f"{self.arguments[0]} cannot be started: {error.strerror or error}."
            ) from None
        self._group = ProcessGroup(self._process)
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    @property
    def exitStatus(self) -> int | None:
        """The program's exit status; None while it runs, whatever has become of what it started."""
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
        # What has left the group may keep the output open for ever.
        return hasEnded and time.monotonic() > self._killAt + LAST_WORDS_S

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
                self._process.wait(LAST_WORDS_S)

    def abandon(self) -> None:
        """Ask it to end, and look after its end in the background."""
        self.end()
        threading.Thread(target=self._finish, daemon=True).start()

    def _finish(self) -> None:
        while not self.poll():
            time.sleep(PERIOD_S)

    def _read(self) -> None:
        with self._process.stdout as output:
            while line := output.readline(LONGEST_LINE):
                self._lines.append(line.rstrip())


def childEnvironment() -> dict[str, str]:
    """Return the environment of every program that Slicer starts: none of Slicer's folders."""
    # Lines are to arrive while the program runs.
    added = {"PYTHONUNBUFFERED": "1", STARTED_BY: SLICER}
    return {**clean_environment(os.environ), **added}


def runChild(
    command: Sequence[str | Path],
    takeLine: Callable[[str], None],
    rest: Callable[[], None],
) -> int:
    """Run a program to its end and return its exit status.

    Args:
        command: its words.
        takeLine: is given each line that it writes.
        rest: is called again and again meanwhile; it may let the application draw, and may raise
            to break the program off, which then ends soon.

    Raises:
        InputError: it cannot be started.
    """
    child = ChildProcess(command)
    try:
        isOver = False
        while not isOver:
            isOver = child.poll()
            for line in child.takeLines():
                takeLine(line)
            rest()
            if not isOver:
                time.sleep(PERIOD_S)
    except BaseException:
        child.abandon()
        raise
    return child.exitStatus
