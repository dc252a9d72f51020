"""From the draft of a head to a scenario's folder: set-up, plan, tasks and picture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head_mesh import HeadMesh
from rastrainer.progress import Progress, Warn
from rastrainer.scenario import PREVIEW_NAME, Provenance, Scenario, load_scenario
from rastrainer.scenario_draft import HeadDraft
from rastrainer.scenario_plan import PlannedTarget, PlannedTrajectory
from rastrainer.scenario_setup import SetUp
from rastrainer.scenario_writer import new_folder, scenario_name, write_scenario
from rastrainer.tasks import Task
from rastrainer_simulator.planning.task_set import TaskSetProposer
from rastrainer_simulator.planning.workbench import Workbench
from rastrainer_simulator.scenarios.picture import draw_preview
from rastrainer_simulator.scenarios.placed_tasks import read_placed_tasks
from rastrainer_simulator.scenarios.plan_check import check_plan, start_clearance_mm

CENTER = "Center of the head"
LEAST_START_CLEARANCE_MM = 30.0
"""Of the tip above the head where a trial starts."""


@dataclass(frozen=True)
class Wishes:
    """What is wanted of a scenario besides its head.

    Attributes:
        title: for people; the name is made of it.
        source, license: for the provenance.
        setup: how the head stands before the robot.
        targets: planned; the target error is told at the first.
        trajectory: planned.
        task_files: markups placed by hand, in the order of the tasks; none proposes them.
        seed: of the proposal.
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
    wishes: Wishes,
    folder: Path,
    progress: Progress = lambda _step, _share: None,
    wait_for_skull: Callable[[], HeadDraft] | None = None,
    warn: Warn = lambda _sentence: None,
) -> Scenario:
    """Write the scenario of a head into a new folder and return it.

    Args:
        draft: of the head; all but its skull is worked with.
        wishes: what else is wanted.
        folder: to be made.
        progress: told each step's name and the share of the work done; may raise to cancel.
        wait_for_skull: returns the same draft with the skull, which is made meanwhile; None where
            `draft` is whole.
        warn: told what is made otherwise than wished, one sentence each.

    Raises:
        InputError: the wishes cannot be met; the sentence says which. Nothing is written then.
    """
    with new_folder(folder) as made:
        scenario = without_tasks(draft, wishes, warn)
        bench = Workbench(scenario, draft.head)
        tasks = _placed(bench, wishes, progress, warn)
        if not tasks:
            tasks = TaskSetProposer(bench, progress).propose(wishes.seed)
        progress("Drawing the picture", 0.95)
        draw_preview(made / PREVIEW_NAME, replace(scenario, tasks=tasks), draft.head)
        if wait_for_skull is not None:
            progress("Making the skull", 0.98)
            draft = wait_for_skull()
        scenario = replace(
            scenario,
            tasks=tasks,
            provenance=replace(scenario.provenance, method=draft.method),
            is_skull_approximate=draft.is_skull_approximate,
        )
        write_scenario(made, scenario, draft.head, draft.skull, draft.volume)
        load_scenario(made)
        progress("Done", 1.0)
    return load_scenario(folder)


def check_wishes(draft: HeadDraft, wishes: Wishes, progress: Progress, warn: Warn) -> None:
    """Raise what `make_scenario` would raise of the set-up, the plan and the placed fiducials.

    Raises:
        InputError: the wishes cannot be met; the sentences say which.
    """
    _placed(Workbench(without_tasks(draft, wishes, warn), draft.head), wishes, progress, warn)


def _placed(bench: Workbench, wishes: Wishes, progress: Progress, warn: Warn) -> tuple[Task, ...]:
    """Return the tasks that are placed by hand, once nothing is wrong with all that is wished."""
    wrong = check_plan(bench)
    tasks, wrong_tasks = read_placed_tasks(bench, wishes.task_files, progress, warn)
    if wrong or wrong_tasks:
        raise InputError(" ".join([*wrong, *wrong_tasks]))
    return tasks


def without_tasks(
    draft: HeadDraft, wishes: Wishes, warn: Warn = lambda _sentence: None
) -> Scenario:
    """Return the scenario of a head without tasks; `warn` is told of a target that lies too deep.

    Raises:
        InputError: the head would not be above the table.
    """
    head, setup = draft.head, wishes.setup
    middle = head.centroid.round(4)
    setup.check_height(float(head.vertices[:, 2].min()), middle)
    scenario = Scenario(
        folder=Path(),
        name=scenario_name(wishes.title),
        title=wishes.title,
        head_mesh=Path(),
        target_name=CENTER,
        target_position=middle,
        head_to_world=setup.head_to_world(middle),
        perturbation=setup.perturbation,
        tasks=(),
        cameras=setup.cameras(),
        furniture=setup.furniture(),
        provenance=Provenance(wishes.source, draft.method, wishes.license),
        is_skull_approximate=draft.is_skull_approximate,
        targets=wishes.targets,
        trajectory=wishes.trajectory,
    )
    return with_main_target(scenario, head, warn)


def with_main_target(scenario: Scenario, head: HeadMesh, warn: Warn) -> Scenario:
    """Return the scenario with the first planned target as its own, where trials can start so.

    A trial starts above the target: with one far below, the tip would start in the head.
    """
    if not scenario.targets:
        return scenario
    first, *others = scenario.targets
    aimed = replace(
        scenario,
        target_name=first.name,
        target_position=np.asarray(first.position, dtype=float),
        targets=tuple(others),
    )
    if start_clearance_mm(aimed, head) >= LEAST_START_CLEARANCE_MM:
        return aimed
    warn(
        f"{first.name} lies too deep for trials to start above it; the target error is told at "
        f"{scenario.target_name}, and {first.name} stays a further target."
    )
    return scenario
