"""Scenarios, made of a head and of what the simulator plans on it.

Fiducials and tasks need the robot, so the simulator's program proposes them.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.progress import Progress, no_progress
from rastrainer.scenario.scenario import Scenario, load_scenario
from rastrainer.scenario.writer import HeadDraft, write_draft
from rastrainer.slicer.background_work import inBackground
from rastrainer.slicer.program.child_process import runChild

HEAD_SHARE = 0.5


def buildScenario(
    make: Callable[[Progress], tuple[HeadDraft, list[str]]],
    folder: Path,
    words: Sequence[str],
    command: Sequence[str],
    progress: Progress = no_progress,
) -> tuple[Scenario, list[str]]:
    """Build a scenario and return it with warnings, one sentence each; see `planScenario`."""
    warnings = planScenario(make, folder, words, command, progress)
    return load_scenario(folder), warnings


def planScenario(
    make: Callable[[Progress], tuple[HeadDraft, list[str]]],
    folder: Path,
    words: Sequence[str],
    command: Sequence[str],
    progress: Progress = no_progress,
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
