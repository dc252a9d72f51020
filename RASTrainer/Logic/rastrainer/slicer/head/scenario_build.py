"""From a volume or a segment in Slicer to a scenario's folder: the whole way, in one call.

The head is made here; fiducials and tasks need the robot, so the simulator proposes them in a
process of its own.
"""

from __future__ import annotations

import contextlib
import tempfile
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError
from pathlib import Path
from typing import TypeVar

from rastrainer.errors import InputError
from rastrainer.progress import Progress, tell_line
from rastrainer.scenario import Scenario, load_scenario
from rastrainer.scenario_draft import HeadDraft, write_draft
from rastrainer.slicer.child_process import ChildProcess

T = TypeVar("T")

HEAD_SHARE = 0.5
PERIOD_S = 0.1


def build_scenario(
    make: Callable[[Progress], tuple[HeadDraft, list[str]]],
    folder: Path,
    words: Sequence[str],
    command: Sequence[str],
    environment: Mapping[str, str] | None = None,
    progress: Progress = lambda _step, _share: None,
) -> tuple[Scenario, list[str]]:
    """Build a scenario and return it with warnings, one sentence each; see `plan_scenario`."""
    warnings = plan_scenario(make, folder, words, command, environment, progress)
    return load_scenario(folder), warnings


def plan_scenario(
    make: Callable[[Progress], tuple[HeadDraft, list[str]]],
    folder: Path,
    words: Sequence[str],
    command: Sequence[str],
    environment: Mapping[str, str] | None = None,
    progress: Progress = lambda _step, _share: None,
) -> list[str]:
    """Make a head, have the simulator plan on it, and return warnings, one sentence each.

    Args:
        make: makes the head with its warnings, such as `make_draft`, in a thread of its own.
        folder: to be made; must be new or empty.
        words: further arguments of `rastrainer scenario tasks`, such as `--title TITLE`; with
            `--check` nothing is made.
        command: words that run `rastrainer` of the simulator's Python.
        environment: of that process; None is this one's.
        progress: told each step's name and the share of the work done, ten times a second; it may
            let the application draw, and may raise to cancel: then nothing is left behind.

    Raises:
        InputError: the volume, the folder or the simulator's program cannot be used.
    """
    draft, warnings = in_background(make, lambda step, share: progress(step, HEAD_SHARE * share))
    with tempfile.TemporaryDirectory() as temporary:
        write_draft(Path(temporary), draft)
        planner = [*command, "scenario", "tasks", temporary, "-o", str(folder), *words]
        return [*warnings, *_run(planner, environment, progress)]


def in_background(work: Callable[[Progress], T], progress: Progress) -> T:
    """Return what `work` returns; meanwhile `progress` is told of it ten times a second.

    Args:
        work: is given what it tells its progress; is broken off there once `progress` has raised.
        progress: may let the application draw, and may raise to cancel.
    """
    told: list[tuple[str, float]] = [("", 0.0)]
    is_cancelled = threading.Event()

    def tell(step: str, share: float) -> None:
        told.append((step, share))
        if is_cancelled.is_set():
            raise _BrokenOffError

    future: Future[T] = Future()

    def run() -> None:
        try:
            future.set_result(work(tell))
        except BaseException as error:
            future.set_exception(error)

    threading.Thread(target=run, daemon=True).start()
    try:
        while not future.done():
            progress(*told[-1])
            with contextlib.suppress(FutureTimeoutError):
                future.exception(PERIOD_S)
    except BaseException:
        is_cancelled.set()
        raise
    return future.result()


class _BrokenOffError(Exception):
    """Nobody waits for the work any more."""


def _run(
    command: Sequence[str], environment: Mapping[str, str] | None, progress: Progress
) -> list[str]:
    """Run the planner of tasks to its end and return its warnings; `progress` may raise to stop."""
    child = ChildProcess(command, environment)
    told = [("Placing fiducials", 0.0)]
    last = "it said nothing"
    warnings: list[str] = []
    try:
        while True:
            status = child.exitStatus
            for line in child.takeLines():
                tell_line(line, lambda *step: told.append(step), warnings.append)
                last = line or last
            step, share = told[-1]
            progress(step, HEAD_SHARE + (1.0 - HEAD_SHARE) * share)
            if status is not None:
                break
            time.sleep(PERIOD_S)
    except BaseException:
        child.stop()
        raise
    if status != 0:
        raise InputError(f"The tasks could not be made: {last.removeprefix('rastrainer: ')}")
    return warnings
