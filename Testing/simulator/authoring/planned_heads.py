"""Two heads that are not Colin27's, with the tasks that the planner once proposed for them.

`python -m Testing.simulator.authoring.planned_heads` proposes them again, in some minutes.
"""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from rastrainer.head.mesh import HeadMesh
from rastrainer.scenario.points import Task, task_file
from rastrainer.scenario.scenario import Scenario
from rastrainer.scenario.writer import HeadDraft, write_scenario
from rastrainer_simulator.authoring.make import ScenarioOptions, without_tasks
from rastrainer_simulator.authoring.planning_setup import PlanningSetup
from rastrainer_simulator.authoring.task_proposal import propose_tasks
from rastrainer_simulator.core.setup import SimulationSetup, load_setup
from Testing.simulator.authoring.heads import egg, small

FILE = Path(__file__).with_name("planned_tasks.json")
HEADS = {"egg": egg, "small": small}
SEED = 1


def setup_of(name: str, folder: Path) -> SimulationSetup:
    """Return the setup of a head by its name, which is written into a folder inside `folder`.

    `colin27` comes with RASTrainer.
    """
    if name not in HEADS:
        return load_setup()
    own = folder / name
    own.mkdir()
    head = HEADS[name]()
    tasks = tuple(
        Task(
            **{**values, "fiducials": np.array(values["fiducials"])}, file=task_file(values["name"])
        )
        for values in json.loads(FILE.read_text(encoding="utf-8"))[name]
    )
    write_scenario(own, replace(_scenario(name, head), tasks=tasks), head, None, None)
    return load_setup(own)


def proposed(name: str) -> tuple[Task, ...]:
    """Return the tasks that the planner proposes for a head."""
    head = HEADS[name]()
    return propose_tasks(PlanningSetup(_scenario(name, head), head), SEED)


def as_json(tasks: tuple[Task, ...]) -> list[dict]:
    """Return the tasks of one head in the file."""
    return [
        {
            **{key: value for key, value in vars(task).items() if key not in ("labels", "file")},
            "fiducials": task.fiducials.tolist(),
        }
        for task in tasks
    ]


def _scenario(name: str, head: HeadMesh) -> Scenario:
    return without_tasks(HeadDraft(head, "made up"), ScenarioOptions(name, "made up", "none"))


if __name__ == "__main__":
    content = {name: as_json(proposed(name)) for name in HEADS}
    FILE.write_text(json.dumps(content) + "\n", encoding="utf-8")
