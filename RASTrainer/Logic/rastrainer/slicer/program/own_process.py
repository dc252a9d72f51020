"""Work in a separate process: a function goes there by its name, and its result comes back.

In a thread, it would share Python's lock with the main thread, which draws Slicer's window. VTK's
filters keep that lock to their end; long loops of Python and numpy take it again and again.
"""

from __future__ import annotations

import importlib
import logging
import pickle
import sys
import tempfile
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.slicer.program.child_process import NotStartedError, runChild
from rastrainer.work_progress import Progress, print_progress

Run = Callable[..., Any]
"""Runs a function: `run(function, progress, *arguments, **named)`; see `OwnProcess`."""

PROTOCOL = pickle.HIGHEST_PROTOCOL
TASK, OUTCOME = "task.pickle", "outcome.pickle"
PROGRAM = """
import sys
sys.path.insert(0, sys.argv[1])
from rastrainer.slicer.program.own_process import main
main(sys.argv[2])
"""
LOGIC = Path(__file__).parents[3]


class OwnProcess:
    """Runs functions, each in a separate process; called in a worker, as it waits for them."""

    def __init__(self, python: Path) -> None:
        """`python` runs the processes."""
        self._python = python

    def __call__(self, function: str, progress: Progress, *arguments: Any, **named: Any) -> Any:
        """Return what `function(*arguments, **named, progress=…)` returns in a separate process.

        Where there is no such process, or it lacks a package, the function runs in this thread.

        Args:
            function: `module:name`; what it takes and returns can be pickled.
            progress: called many times a second with what the function has reported last; may raise
                to end the process.
            arguments: of the function, besides its `progress`.
            named: further ones.

        Raises:
            InputError: the function did, or the process ended before it was done.
        """
        with tempfile.TemporaryDirectory(prefix="RASTrainer-") as temporary:
            folder = Path(temporary)
            _write(folder / TASK, (function, arguments, named))
            try:
                ended = runChild((self._python, "-c", PROGRAM, LOGIC, folder), progress)
            except NotStartedError as error:
                logging.warning("%s %s runs in Slicer itself.", error, function)
                return runHere(function, progress, *arguments, **named)
            outcome = folder / OUTCOME
            if not outcome.is_file():
                reason = ended.lastLine or "it wrote nothing"
                raise InputError(f"A process of Slicer's Python ended before it was done: {reason}")
            kind, value = _read(outcome)
        if kind == "refused":
            raise InputError(value)
        if kind == "missing":
            logging.warning("%s lacks %s: %s runs in Slicer.", self._python, value, function)
            return runHere(function, progress, *arguments, **named)
        return value


def runHere(function: str, progress: Progress, *arguments: Any, **named: Any) -> Any:
    """Return what the function returns in this thread; otherwise as `OwnProcess`."""
    return _find(function)(*arguments, **named, progress=progress)


def main(folder: str) -> None:
    """Do the task in a folder, and leave its outcome there."""
    path = Path(folder)
    try:
        function, arguments, named = _read(path / TASK)
        outcome = "done", runHere(function, print_progress, *arguments, **named)
    except InputError as error:
        outcome = "refused", str(error)
    except ImportError as error:
        outcome = "missing", str(error.name)
    except Exception:
        traceback.print_exc()
        sys.exit(1)
    partial = path / f"{OUTCOME}.partial"
    _write(partial, outcome)
    partial.replace(path / OUTCOME)


def _write(path: Path, value: Any) -> None:
    """Write a value; arrays go to the file as they are, which leaves Python's lock to others."""
    buffers: list[pickle.PickleBuffer] = []
    head = pickle.dumps(value, PROTOCOL, buffer_callback=buffers.append)
    with path.open("wb") as file:
        views = [memoryview(head), *(buffer.raw() for buffer in buffers)]
        pickle.dump([view.nbytes for view in views], file, PROTOCOL)
        for view in views:
            file.write(view)


def _read(path: Path) -> Any:
    """Return the value that `_write` has written."""
    with path.open("rb") as file:
        head, *buffers = [bytearray(size) for size in pickle.load(file)]
        for buffer in (head, *buffers):
            file.readinto(buffer)
    return pickle.loads(head, buffers=buffers)


def _find(function: str) -> Callable[..., Any]:
    module, _, name = function.partition(":")
    return getattr(importlib.import_module(module), name)
