"""A program that runs beside Slicer: started, listened to line by line, and ended."""

from __future__ import annotations

import contextlib
import os
import subprocess
import threading
from collections import deque
from collections.abc import Mapping, Sequence
from pathlib import Path

from rastrainer.errors import InputError

LINES_KEPT = 2000
LONGEST_LINE = 2000
KILL_AFTER_S = 5.0


class ChildProcess:
    """A program with its output; nothing here waits for it but `wait` and `stop`.

    Attributes:
        arguments: what was started.
    """

    def __init__(
        self, arguments: Sequence[str | Path], environment: Mapping[str, str] | None = None
    ) -> None:
        """Start the program.

        Raises:
            InputError: it cannot be started.
        """
        self.arguments = [str(argument) for argument in arguments]
        self._lines: deque[str] = deque(maxlen=LINES_KEPT)
        try:
            self._process = subprocess.Popen(
                self.arguments,
                env=None if environment is None else dict(environment),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                encoding="utf-8",
                errors="replace",
                # Windows would open a console window for it.
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )
        except OSError as error:
            raise InputError(
                f"{self.arguments[0]} cannot be started: {error.strerror or error}."
            ) from None
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    @property
    def exitStatus(self) -> int | None:
        """The exit status; None while it runs, or while the last of its output is read."""
        return None if self._reader.is_alive() else self._process.poll()

    def takeLines(self) -> list[str]:
        """Return the lines that it has written since the last call."""
        lines = []
        with contextlib.suppress(IndexError):
            while True:
                lines.append(self._lines.popleft())
        return lines

    def wait(self) -> int:
        """Wait until it has ended, and return its exit status; only for what is soon done."""
        self._reader.join()
        return self._process.wait()

    def stop(self) -> None:
        """Ask it to end, and end it where it does not within seconds."""
        self._process.terminate()
        try:
            self._process.wait(KILL_AFTER_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._reader.join(KILL_AFTER_S)

    def _read(self) -> None:
        with self._process.stdout as output:
            while line := output.readline(LONGEST_LINE):
                self._lines.append(line.rstrip())
        self._process.wait()


def environmentWith(folder: Path) -> dict[str, str]:
    """Return this process's environment for a Python that looks for packages in `folder` first."""
    environment = dict(os.environ)
    paths = [str(folder), environment.get("PYTHONPATH", "")]
    environment["PYTHONPATH"] = os.pathsep.join(path for path in paths if path)
    # Packages of the user's own Python are none of the simulator's business.
    environment["PYTHONNOUSERSITE"] = "1"
    environment["PYTHONUNBUFFERED"] = "1"
    return environment
