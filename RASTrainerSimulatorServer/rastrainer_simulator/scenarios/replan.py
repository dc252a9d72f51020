"""Give a head another plan: a copy of its scenario with other targets or another trajectory."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head_mesh import read_head_mesh
from rastrainer.head_volume import read_head_volume
from rastrainer.scenario import PREVIEW_NAME, Scenario, load_scenario
from rastrainer.scenario_package import checked_scenario
from rastrainer.scenario_plan import PlannedTarget, PlannedTrajectory
from rastrainer.scenario_writer import new_folder, scenario_name, write_scenario
from rastrainer_simulator.planning.task_check import check_tasks
from rastrainer_simulator.planning.workbench import Workbench
from rastrainer_simulator.scenarios.make import with_main_target
from rastrainer_simulator.scenarios.picture import draw_preview
from rastrainer_simulator.scenarios.plan_check import check_plan


def copy_with_plan(
    folder: Path,
    title: str,
    copy: Path,
    targets: tuple[PlannedTarget, ...],
    trajectory: PlannedTrajectory | None,
    warn: Callable[[str], None],
) -> Scenario:
    """Write a copy of a scenario with another plan and return it.

    Args:
        folder: of the scenario, which stays as it is.
        title: of the copy; its name is made of it.
        copy: a new folder.
        targets: RAS mm, in the place of all it had; the first is where the error is told. Empty
            keeps what it had.
        trajectory: RAS mm, in the place of that it had; None keeps it.
        warn: told of a first target that lies too deep for trials to start above it.

    Raises:
        InputError: the scenario cannot be used, or the plan cannot be carried out. Nothing is
            written then.
    """
    before = checked_scenario(folder)
    head = read_head_mesh(before.head_mesh)
    skull = read_head_mesh(before.skull_mesh) if before.skull_mesh else None
    volume = read_head_volume(before.volume) if before.volume else None
    scenario = replace(
        before, name=scenario_name(title), title=title, trajectory=trajectory or before.trajectory
    )
    if targets:
        scenario = with_main_target(replace(scenario, targets=targets), head, warn)
    bench = Workbench(scenario, head)
    wrong = check_plan(bench)
    # Trials start above the target and turn the head about it, so that touching depends on it.
    if not np.array_equal(scenario.target_position, before.target_position):
        wrong += check_tasks(bench, scenario.tasks)
    if wrong:
        raise InputError(" ".join(wrong))
    with new_folder(copy) as made:
        write_scenario(made, scenario, head, skull, volume)
        draw_preview(made / PREVIEW_NAME, scenario, head)
        load_scenario(made)
    return load_scenario(copy)
