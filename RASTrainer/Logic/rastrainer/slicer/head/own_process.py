"""Heads and scenarios, made in separate processes.

VTK's filters would keep Slicer's window from answering, so the head is made by a Python beside it:
the function and its arguments go there and its result comes back as files in a private folder.
Fiducials and tasks need the robot, so the simulator proposes them.
"""

from __future__ import annotations

import importlib
import logging
import pickle
import sys
import tempfile
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.progress import Progress, print_progress
from rastrainer.scenario.scenario import Scenario, load_scenario
from rastrainer.scenario.writer import HeadDraft, write_draft
from rastrainer.slicer.background_work import inBackground
from rastrainer.slicer.program.child_process import runChild

TASK, OUTCOME = "task.pickle", "outcome.pickle"
PROGRAM = """
import sys
sys.path.insert(0, sys.argv[1])
from rastrainer.slicer.head.own_process import main
main(sys.argv[2])
"""
LOGIC = Path(__file__).parents[3]


def inOwnProcess(
    python: Path, function: str, progress: Progress, *arguments: Any, **named: Any
) -> Any:
    """Return what `function(*arguments, **named, progress=…)` returns in a separate process.

    It waits, so it is called in a thread. Where that process lacks a package, the function runs
    in this thread.

    Args:
        python: that runs it.
        function: `module:name`; what it takes and returns can be pickled.
        progress: called with what the function reports; may raise to cancel it.
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


HEAD_SHARE = 0.5


def buildScenario(
    make: Callable[[Progress], tuple[HeadDraft, list[str]]],
    folder: Path,
    words: Sequence[str],
    command: Sequence[str],
    progress: Progress = lambda _step, _share: None,
) -> tuple[Scenario, list[str]]:
    """Build a scenario and return it with warnings, one sentence each; see `planScenario`."""
    warnings = planScenario(make, folder, words, command, progress)
    return load_scenario(folder), warnings


def planScenario(
    make: Callable[[Progress], tuple[HeadDraft, list[str]]],
    folder: Path,
    words: Sequence[str],
    command: Sequence[str],
    progress: Progress = lambda _step, _share: None,
) -> list[str]:
    """Make a head, have the simulator plan on it, and return warnings, one sentence each.

    Args:
        make: makes the head with its warnings, such as `makeDraft`, called in a worker thread.
        folder: to be made; must be new or empty.
        words: further arguments of `rastrainer scenario tasks`, such as `--title TITLE`; with
            `--check` nothing is made.
        command: words that run `rastrainer` of the simulator's Python.
        progress: called with each step's name and the share of the work done, many times a
            second; it may let the application draw, and may raise to cancel: nothing is left then.

    Raises:
        InputError: the volume, the folder or the simulator's program cannot be used.
    """
    with tempfile.TemporaryDirectory() as temporary:

        def makeAndWrite(report: Progress) -> list[str]:
            draft, warnings = make(report)
            write_draft(Path(temporary), draft)
            return warnings

        warnings = inBackground(
            makeAndWrite, lambda step, share: progress(step, HEAD_SHARE * share)
        )
        planner = [*command, "scenario", "tasks", temporary, "-o", str(folder), *words]
        return [*warnings, *_run(planner, progress)]


def _run(command: Sequence[str], progress: Progress) -> list[str]:
    """Run the planner of tasks to its end and return its warnings; `progress` may raise to stop."""

    def showShare(step: str, share: float) -> None:
        progress(step, HEAD_SHARE + (1.0 - HEAD_SHARE) * share)

    ended = runChild(command, showShare, "Placing fiducials")
    if ended.exitStatus != 0:
        reason = ended.lastLine.removeprefix("rastrainer: ") or "it wrote nothing"
        raise InputError(f"The tasks could not be made: {reason}")
    return list(ended.warnings)
