"""From a volume or a segment in Slicer to a scenario's folder: the whole way, in one call.

The head is made here; fiducials and tasks need the robot, so the simulator proposes them in a
process of its own.
"""

from __future__ import annotations

import contextlib
import re
import tempfile
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from rastrainer.errors import InputError
from rastrainer.scenario import Scenario, load_scenario
from rastrainer.scenario_draft import HeadDraft, write_draft
from rastrainer.slicer.child_process import ChildProcess
from rastrainer.slicer.head.extraction import HeadSettings, Progress
from rastrainer.slicer.head.head_draft import make_draft
from rastrainer.slicer.head.volume import Volume

T = TypeVar("T")

HEAD_SHARE = 0.5
PERIOD_S = 0.1
_PROGRESS = re.compile(r"\s*(\d+)%  (.+)")


@dataclass(frozen=True)
class BuildRequest:
    """What to build.

    Attributes:
        volume: of a volume node (`volume_from_node`).
        folder: to be made; must be new or empty.
        source: where the images come from, for the scenario's provenance.
        license: under which the scenario may be used.
        title: for people; None takes the folder's name.
        settings: of the head's extraction.
        has_skull: whether the skull is wanted too.
        words: further arguments of `rastrainer scenario tasks`, such as `--setup FILE`.
        segment: the head in the volume (`volume_of_segment`); None finds it.
    """

    volume: Volume
    folder: Path
    source: str
    license: str
    title: str | None = None
    settings: HeadSettings = field(default_factory=HeadSettings)
    has_skull: bool = True
    words: tuple[str, ...] = ()
    segment: Volume | None = None


def build_scenario(
    request: BuildRequest,
    command: Sequence[str],
    environment: Mapping[str, str] | None = None,
    progress: Progress = lambda _step, _share: None,
) -> tuple[Scenario, list[str]]:
    """Build a scenario and return it with warnings, one sentence each.

    Args:
        request: what to build.
        command: words that run `rastrainer` of the simulator's Python.
        environment: of that process; None is this one's.
        progress: told each step's name and the share of the work done, ten times a second; it may
            let the application draw, and may raise to cancel: then nothing is left behind.

    Raises:
        InputError: the volume, the folder or the simulator's program cannot be used.
    """
    draft, warnings = in_background(
        lambda tell: make_draft(
            request.volume, request.settings, request.has_skull, tell, request.segment
        ),
        lambda step, share: progress(step, HEAD_SHARE * share),
    )
    return finish_scenario(draft, request, command, environment, progress), warnings


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


def finish_scenario(
    draft: HeadDraft,
    request: BuildRequest,
    command: Sequence[str],
    environment: Mapping[str, str] | None = None,
    progress: Progress = lambda _step, _share: None,
) -> Scenario:
    """Build the scenario of a head that is made already; otherwise as `build_scenario`."""
    folder = Path(request.folder).absolute()
    with tempfile.TemporaryDirectory() as temporary:
        write_draft(Path(temporary), draft)
        words = ["scenario", "tasks", temporary, "-o", str(folder), *request.words]
        words += ["--source", request.source, "--license", request.license]
        if request.title:
            words += ["--title", request.title]
        _run([*command, *words], environment, progress)
    return load_scenario(folder)


def _run(command: Sequence[str], environment: Mapping[str, str] | None, progress: Progress) -> None:
    """Run the planner of tasks to its end; where `progress` raises it is stopped."""
    child = ChildProcess(command, environment)
    step, share, last = "Placing fiducials", HEAD_SHARE, "it said nothing"
    try:
        while True:
            status = child.exitStatus
            for line in child.takeLines():
                told = _PROGRESS.fullmatch(line)
                if told:
                    step = told.group(2)
                    share = HEAD_SHARE + (1.0 - HEAD_SHARE) * int(told.group(1)) / 100.0
                last = line or last
            progress(step, share)
            if status is not None:
                break
            time.sleep(PERIOD_S)
    except BaseException:
        child.stop()
        raise
    if status != 0:
        raise InputError(f"The tasks could not be made: {last.removeprefix('rastrainer: ')}")
