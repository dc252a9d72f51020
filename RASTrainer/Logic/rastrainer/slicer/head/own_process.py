"""Makes a head in a process of its own: VTK's filters would keep Slicer's window from answering.

The function and what it works on go there and back as files in a private folder.
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
from rastrainer.progress import Progress, print_progress
from rastrainer.slicer.program.child_process import runChild

TASK, OUTCOME = "task.pickle", "outcome.pickle"
PROGRAM = """
import sys
sys.path.insert(0, sys.argv[1])
from rastrainer.slicer.head.own_process import main
main(sys.argv[2])
"""
LOGIC = Path(__file__).parents[3]


def in_own_process(
    python: Path, function: str, progress: Progress, *arguments: Any, **named: Any
) -> Any:
    """Return what `function(*arguments, **named, progress=…)` returns in a process of its own.

    It waits, so it is called in a thread. Where that process lacks a package, the function runs
    in this thread.

    Args:
        python: that runs it.
        function: `module:name`; what it takes and returns can be pickled.
        progress: told what the function tells; may raise to break it off.
        arguments: of the function, besides its `progress`.

    Raises:
        InputError: the function did, or the process ended before it was done.
    """
    with tempfile.TemporaryDirectory(prefix="RASTrainer-") as temporary:
        folder = Path(temporary)
        with (folder / TASK).open("wb") as file:
            pickle.dump((function, arguments, named), file, pickle.HIGHEST_PROTOCOL)
        ended = runChild((python, "-c", PROGRAM, LOGIC, folder), progress)
        outcome = folder / OUTCOME
        if not outcome.is_file():
            raise InputError(f"The head could not be made: {ended.lastLine or 'its process ended'}")
        kind, value = pickle.loads(outcome.read_bytes())
    if kind == "refused":
        raise InputError(value)
    if kind == "missing":
        logging.warning("%s lacks %s: the head is made in Slicer itself.", python, value)
        return _find(function)(*arguments, **named, progress=progress)
    return value


def main(folder: str) -> None:
    """Do the task in a folder, and leave its outcome there."""
    path = Path(folder)
    try:
        with (path / TASK).open("rb") as file:
            function, arguments, named = pickle.load(file)
        outcome = "done", _find(function)(*arguments, **named, progress=print_progress)
    except InputError as error:
        outcome = "refused", str(error)
    except ImportError as error:
        outcome = "missing", str(error.name)
    except Exception:
        traceback.print_exc()
        sys.exit(1)
    partial = path / f"{OUTCOME}.partial"
    with partial.open("wb") as written:
        pickle.dump(outcome, written, pickle.HIGHEST_PROTOCOL)
    partial.replace(path / OUTCOME)


def _find(function: str) -> Callable[..., Any]:
    module, _, name = function.partition(":")
    return getattr(importlib.import_module(module), name)
