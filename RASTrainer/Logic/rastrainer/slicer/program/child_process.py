"""A program that runs next to Slicer: started, read line by line, and ended.

Slicer's Python is a launcher that starts the real Python and forwards no signal: killing the
launcher alone would leave the real process. Both are therefore ended as a group: their session, or
on Windows their tree of processes. The end of Slicer does not end the program: a running trial
survives a crash of Slicer.

A function runs in such a program, too: it goes there by its name, and its result comes back. In a
thread, it would share Python's lock with the main thread, which draws Slicer's window. VTK's
filters keep that lock to their end; long loops of Python and numpy take it again and again.
"""

from __future__ import annotations

import contextlib
import importlib
import logging
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.journal.folder import STARTED_BY
from rastrainer.python_environment import clean_environment
from rastrainer.work_progress import Progress, print_progress, report_line

LINES_KEPT = 2000
LONGEST_LINE = 2000
KILL_AFTER_S = 5.0
LAST_OUTPUT_S = 1.0
"""How long to wait for the output of a killed program."""
CLOSING_S = 0.5
"""How long `close` waits for an orderly end: Slicer's user waits for that."""
PERIOD_S = 0.02
SLICER = "Slicer"
OPTIONS: dict[str, Any]
"""For `subprocess.Popen`."""

if sys.platform == "win32":
    # Without it, Windows opens a console window.
    OPTIONS = {"creationflags": subprocess.CREATE_NO_WINDOW}

    def endGroup(leader: int, isAsked: bool) -> None:  # noqa: ARG001
        """End a process and its tree at once: nothing can ask a program without a window."""
        words = ["taskkill", "/F", "/T", "/PID", str(leader)]
        subprocess.Popen(words, stdin=subprocess.DEVNULL, **OPTIONS)

    def endProcess(pid: int, hasOwnGroup: bool, isAsked: bool) -> None:  # noqa: ARG001
        endGroup(pid, isAsked)

else:
    OPTIONS = {"start_new_session": True}

    def endGroup(leader: int, isAsked: bool) -> None:
        """Ask a program started with `OPTIONS` and all that it has started to end, or kill them."""
        # They may all have ended; on macOS, those that have may wait to be noticed.
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(leader, signal.SIGTERM if isAsked else signal.SIGKILL)

    def endProcess(pid: int, hasOwnGroup: bool, isAsked: bool) -> None:
        """End a process that this one has not started, or raise PermissionError.

        If it was started with `OPTIONS` (`hasOwnGroup`), all that it has started ends, too.
        """
        number = signal.SIGTERM if isAsked else signal.SIGKILL
        with contextlib.suppress(ProcessLookupError):
            if hasOwnGroup:
                os.killpg(os.getpgid(pid), number)
            else:
                os.kill(pid, number)


class NotStartedError(InputError):
    """A program cannot be started."""


class ChildProcess:
    """A program with its output; only `close` waits, and briefly."""

    def __init__(
        self, arguments: Sequence[str | Path], environment: Mapping[str, str] | None = None
    ) -> None:
        """Start the program, in the environment of `childEnvironment` unless another is given, or
        raise `NotStartedError`."""
        self._lines: deque[str] = deque(maxlen=LINES_KEPT)
        self._killAt: float | None = None
        try:
            self.process = subprocess.Popen(
                [str(argument) for argument in arguments],
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
            raise NotStartedError(
                f"{arguments[0]} cannot be started: {error.strerror or error}."
            ) from None
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def poll(self) -> bool:
        """Return whether it has ended, and so has all that it started.

        Called again and again, this ends what the program has left behind, and kills what does not
        end within seconds.
        """
        hasEnded = self.process.poll() is not None
        # What it has started holds the other end of its output.
        if hasEnded and not self._reader.is_alive():
            return True
        if hasEnded:
            self.end()
        if self._killAt is None or time.monotonic() < self._killAt:
            return False
        endGroup(self.process.pid, isAsked=False)
        # A process that has left the group may keep the output open forever.
        return hasEnded and time.monotonic() > self._killAt + LAST_OUTPUT_S

    def takeLines(self) -> list[str]:
        return [self._lines.popleft() for _ in range(len(self._lines))]

    def end(self) -> None:
        """Ask the program and all that it has started to end, once; see `poll`."""
        if self._killAt is None:
            self._killAt = time.monotonic() + KILL_AFTER_S
            endGroup(self.process.pid, isAsked=True)

    def close(self) -> None:
        """End it and all that it has started, in order where that takes half a second at most."""
        self.end()
        self._reader.join(CLOSING_S)
        if not self.poll():
            endGroup(self.process.pid, isAsked=False)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.process.wait(LAST_OUTPUT_S)

    def abandon(self) -> None:
        def finish() -> None:
            while not self.poll():
                time.sleep(PERIOD_S)

        self.end()
        threading.Thread(target=finish, daemon=True).start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        with self.process.stdout as output:
            while line := output.readline(LONGEST_LINE):
                self._lines.append(line.rstrip())


def childEnvironment() -> dict[str, str]:
    """Return the environment of every program that Slicer starts: none of Slicer's folders."""
    # Lines are to arrive while the program runs.
    added = {"PYTHONUNBUFFERED": "1", STARTED_BY: SLICER}
    return {**clean_environment(os.environ), **added}


@dataclass
class ChildResult:
    """Exit status of a program, its last line that is not empty, and its warnings."""

    exitStatus: int | None = None
    lastLine: str = ""
    warnings: list[str] = field(default_factory=list)


def runChild(command: Sequence[str | Path], progress: Progress, firstStep: str = "") -> ChildResult:
    """Run a program to its end.

    `progress` is called many times a second with the step and share that the program has printed
    last (see `print_progress`), before with `firstStep`. It may let the application draw, and may
    raise to break the program off, which then ends soon.
    """
    child, result = ChildProcess(command), ChildResult()
    steps = [(firstStep, 0.0)]
    try:
        isOver = False
        while not isOver:
            isOver = child.poll()
            for line in child.takeLines():
                report_line(line, lambda *step: steps.append(step), result.warnings.append)
                result.lastLine = line or result.lastLine
            progress(*steps[-1])
            if not isOver:
                time.sleep(PERIOD_S)
    except BaseException:
        child.abandon()
        raise
    result.exitStatus = child.process.poll()
    return result


Run = Callable[..., Any]
"""Runs a function: `run(function, progress, *arguments, **named)`; see `OwnProcess`."""

TASK, OUTCOME = "task.pickle", "outcome.pickle"
PROGRAM = """
import sys
sys.path.insert(0, sys.argv[1])
from rastrainer.slicer.program.child_process import main
main(sys.argv[2])
"""
LOGIC = Path(__file__).parents[3]


class OwnProcess:
    """Runs functions, each in a separate process; called in a worker, as it waits for them."""

    def __init__(self, python: Path) -> None:
        self._python = python

    def __call__(self, function: str, progress: Progress, *arguments: Any, **named: Any) -> Any:
        """Return what `function(*arguments, **named, progress=…)` returns in a separate process.

        `function` is `module:name`; its arguments and its result can be pickled. If no such process
        can be started, it runs in this thread. `progress` may raise to end the process.
        """
        with tempfile.TemporaryDirectory(prefix="RASTrainer-") as temporary:
            folder = Path(temporary)
            # Straight to the file, which leaves Python's lock to others.
            with (folder / TASK).open("wb") as file:
                pickle.dump((function, arguments, named), file, pickle.HIGHEST_PROTOCOL)
            try:
                ended = runChild((self._python, "-c", PROGRAM, LOGIC, folder), progress)
            except NotStartedError as error:
                logging.warning("%s %s runs in Slicer itself.", error, function)
                return runHere(function, progress, *arguments, **named)
            outcome = folder / OUTCOME
            if ended.exitStatus != 0 or not outcome.is_file():
                reason = ended.lastLine or "it wrote nothing"
                raise InputError(f"A process of Slicer's Python ended before it was done: {reason}")
            kind, value = pickle.loads(outcome.read_bytes())
        if kind == "refused":
            raise InputError(value)
        return value


def runHere(function: str, progress: Progress, *arguments: Any, **named: Any) -> Any:
    """Return what the function returns in this thread; otherwise as `OwnProcess`."""
    module, _, name = function.partition(":")
    return getattr(importlib.import_module(module), name)(*arguments, **named, progress=progress)


def main(folder: str) -> None:
    path = Path(folder)
    try:
        function, arguments, named = pickle.loads((path / TASK).read_bytes())
        outcome = "done", runHere(function, print_progress, *arguments, **named)
    except InputError as error:
        outcome = "refused", str(error)
    except Exception:
        traceback.print_exc()
        sys.exit(1)
    (path / OUTCOME).write_bytes(pickle.dumps(outcome, pickle.HIGHEST_PROTOCOL))
