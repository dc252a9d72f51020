"""Make a scenario of a head, or a copy of one with another plan."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TextIO

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.procedure.plan import Procedure
from rastrainer.python_environment import python_command
from rastrainer.scenario.library import checked_scenario
from rastrainer.scenario.points import Landmark, PlannedTarget, PlannedTrajectory, Task, on_skin
from rastrainer.scenario.scenario import (
    FORMAT_VERSION,
    PREVIEW_NAME,
    Provenance,
    Scenario,
    SkullFile,
    load_scenario,
)
from rastrainer.scenario.setup import SetUp
from rastrainer.scenario.writer import (
    HEAD_NAME,
    SKULL_NAME,
    HeadDraft,
    new_folder,
    read_draft,
    read_files,
    scenario_name,
    write_scenario,
)
from rastrainer.work_progress import HEAD_MADE, Progress, Warn, no_progress, report_line
from rastrainer_simulator.authoring.landmarks import check_on_planned_head
from rastrainer_simulator.authoring.planning_setup import PlanningSetup
from rastrainer_simulator.authoring.procedure_plan import measure_procedure, with_procedure
from rastrainer_simulator.authoring.scenario_check import (
    check_plan,
    check_tasks,
    read_placed_tasks,
    start_clearance_mm,
)
from rastrainer_simulator.authoring.task_proposal import propose_tasks
from rastrainer_simulator.rendering.picture import draw_preview

CENTER = "Center of the head"
LEAST_START_CLEARANCE_MM = 30.0
"""Least distance of the tip from the head at the start of a trial."""


@dataclass(frozen=True)
class ScenarioOptions:
    """The options of a scenario besides its head.

    Attributes:
        targets: planned; the target error is reported at the first.
        task_files: manually placed markups, in the order of the tasks; without any, tasks are
            proposed.
    """

    title: str
    source: str
    license: str
    setup: SetUp = field(default_factory=SetUp)
    targets: tuple[PlannedTarget, ...] = ()
    trajectory: PlannedTrajectory | None = None
    task_files: tuple[Path, ...] = ()
    seed: int = 1


def make_scenario(
    draft: HeadDraft,
    options: ScenarioOptions,
    folder: Path,
    progress: Progress = no_progress,
    wait_for_skull: Callable[[], HeadDraft] | None = None,
    warn: Warn = lambda _sentence: None,
) -> Scenario:
    """Write the scenario of a head into a new folder and return it.

    `progress` may raise to cancel; `warn` is called with a sentence for each deviation from the
    options. `wait_for_skull` returns the same draft with the skull, which is made meanwhile; it is
    None if `draft` is complete.
    """
    with new_folder(folder) as made:
        planning, tasks = check_options(draft, options, progress, warn)
        scenario = planning.scenario
        if not tasks:
            tasks = propose_tasks(planning, options.seed, progress)
        progress("Drawing the picture", 0.95)
        draw_preview(made / PREVIEW_NAME, replace(scenario, tasks=tasks), draft.head)
        if wait_for_skull is not None:
            progress("Making the skull", 0.98)
            draft = wait_for_skull()
        scenario = replace(
            scenario,
            tasks=tasks,
            provenance=replace(scenario.provenance, method=draft.method),
            skull=SkullFile(SKULL_NAME, draft.skull_kind),
        )
        write_scenario(made, scenario, draft.head, draft.skull, draft.volume)
        load_scenario(made)
        progress("Done", 1.0)
    return load_scenario(folder)


def check_options(
    draft: HeadDraft, options: ScenarioOptions, progress: Progress, warn: Warn
) -> tuple[PlanningSetup, tuple[Task, ...]]:
    """Return the set-up and the manually placed tasks if both and the plan are all right."""
    planning = PlanningSetup(without_tasks(draft, options, warn), draft.head)
    wrong = check_plan(planning)
    tasks, wrong_tasks = read_placed_tasks(planning, options.task_files, progress, warn)
    if wrong or wrong_tasks:
        raise InputError(" ".join([*wrong, *wrong_tasks]))
    return planning, tasks


def without_tasks(
    draft: HeadDraft, options: ScenarioOptions, warn: Warn = lambda _sentence: None
) -> Scenario:
    """Return the scenario of a head without tasks; warn of a first target that is too deep."""
    head, setup = draft.head, options.setup
    middle = head.centroid.round(4)
    setup.check_height(float(head.vertices[:, 2].min()), middle)
    scenario = Scenario(
        format_version=FORMAT_VERSION,
        name=scenario_name(options.title),
        title=options.title,
        head=HEAD_NAME,
        target=PlannedTarget(CENTER, middle),
        head_to_world=setup.head_to_world(middle),
        perturbation=setup.perturbation,
        tasks=(),
        cameras=setup.cameras(),
        table=setup.table_in_world(),
        stand=setup.stand,
        provenance=Provenance(options.source, draft.method, options.license),
        targets=options.targets,
        trajectory=options.trajectory,
    )
    return _with_main_target(scenario, head, warn)


def _with_main_target(scenario: Scenario, head: HeadMesh, warn: Warn) -> Scenario:
    """Return the scenario with the first planned target as its main one, if trials can start there.

    A trial starts above the main target: with a deep one, the tip would start in the head.
    """
    if not scenario.targets:
        return scenario
    first, *others = scenario.targets
    aimed = replace(scenario, target=first, targets=tuple(others))
    if start_clearance_mm(aimed, head) >= LEAST_START_CLEARANCE_MM:
        return aimed
    warn(
        f"{first.name} is too deep for trials to start above it; the target error is reported at "
        f"{scenario.target.name}, and {first.name} remains a further target."
    )
    return scenario


def copy_with_plan(
    folder: Path,
    copy: Path,
    warn: Warn,
    title: str,
    targets: tuple[PlannedTarget, ...],
    trajectory: PlannedTrajectory | None,
    procedure: Procedure | None = None,
    landmarks: tuple[Landmark, ...] | None = None,
) -> Scenario:
    """Write a copy of a scenario with another plan into a new folder and return it.

    Arguments that are empty or None change nothing; a procedure replaces the procedure of the same
    name, all other arguments replace the present values. The target error is reported at the first
    target; `warn` is called if it is too deep for trials to start above it. Landmarks near the skin
    are moved onto it.
    """
    before = checked_scenario(folder)
    head, skull, volume, no_go = read_files(before)
    scenario = replace(
        before, name=scenario_name(title), title=title, trajectory=trajectory or before.trajectory
    )
    if targets:
        scenario = _with_main_target(replace(scenario, targets=targets), head, warn)
    if procedure is not None:
        scenario, no_go = with_procedure(scenario, procedure)
    if landmarks is not None:
        scenario = replace(scenario, landmarks=on_skin(head, landmarks))
    planning = PlanningSetup(scenario, head)
    wrong = check_plan(planning)
    if procedure is not None:
        wrong += measure_procedure(planning, procedure).wrong
    if landmarks is not None:
        wrong += check_on_planned_head(planning, landmarks)
    # Trials start above the target and turn the head about it, so that touching depends on it.
    if not np.array_equal(scenario.target.position_ras, before.target.position_ras):
        wrong += check_tasks(planning, scenario.tasks)
    if wrong:
        raise InputError(" ".join(wrong))
    with new_folder(copy) as made:
        write_scenario(made, scenario, head, skull, volume, no_go)
        # The picture needs the meshes where they were written.
        draw_preview(made / PREVIEW_NAME, load_scenario(made), head)
    return load_scenario(copy)


MAKE_HEAD = "rastrainer_headless.make_head"


@dataclass(frozen=True)
class HeadProcess:
    """A process that makes the head, and then its skull while the head is already used."""

    process: subprocess.Popen[str]
    errors: TextIO
    folder: Path

    def head(self, progress: Progress, warn: Warn) -> HeadDraft:
        """Wait for the head, and return its draft without a skull; `progress` may cancel."""
        assert self.process.stdout is not None  # It is a pipe.
        for line in self.process.stdout:
            if line.rstrip() == HEAD_MADE:
                return read_draft(self.folder)
            report_line(line.rstrip(), progress, warn)
        return self.whole()

    def whole(self) -> HeadDraft:
        """Wait for the skull too, if one is wanted, and return the whole draft."""
        assert self.process.stdout is not None  # It is a pipe.
        self.process.stdout.read()
        status = self.process.wait()
        if status != 0:
            self.errors.seek(0)
            lines = self.errors.read().strip().splitlines()
            raise InputError(lines[-1] if lines else f"The head's process ended with {status}.")
        return read_draft(self.folder)


@contextmanager
def head_process(volume: Path, options: list[str]) -> Iterator[HeadProcess]:
    """Yield a process that makes the head in a volume; it ends with the context.

    The volume is NRRD, NIfTI, or a folder of DICOM files; `options` are further arguments of
    `python -m rastrainer_headless.make_head`.
    """
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / "draft"
        words = python_command(MAKE_HEAD, str(volume), "-o", str(folder), *options)
        with (
            tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as errors,
            subprocess.Popen(words, stdout=subprocess.PIPE, stderr=errors, text=True) as process,
        ):
            try:
                yield HeadProcess(process, errors, folder)
            finally:
                process.kill()
