"""Everything that can be wrong with a scenario on disk, one sentence each."""

from __future__ import annotations

from pathlib import Path

from rastrainer.head_mesh import read_head_mesh
from rastrainer.scenario_package import checked_scenario
from rastrainer_simulator.planning.task_check import check_tasks
from rastrainer_simulator.planning.workbench import Workbench
from rastrainer_simulator.scenarios.plan_check import check_plan


def check_scenario(folder: Path) -> list[str]:
    """Return what is wrong with the set-up, the plan and the tasks of a scenario.

    Raises:
        InputError: it cannot be read at all.
    """
    scenario = checked_scenario(folder)
    mesh = read_head_mesh(scenario.head_mesh)
    wrong = []
    if mesh.euler_characteristic != 2:
        wrong.append("The head's surface has tunnels or loose parts; the skin must be one body.")
    bench = Workbench(scenario, mesh)
    return wrong + check_plan(bench) + check_tasks(bench, scenario.tasks)
