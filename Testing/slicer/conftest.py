import time

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.head.mesh import write_head_mesh
from rastrainer.scenario.points import PlannedTarget, Task, task_file
from rastrainer.scenario.scenario import Perturbation, Scenario
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.program.child_process import OwnProcess, runHere
from rastrainer.trial.scoring import SAFETY_METRICS
from rastrainer_headless.connector import headlessKit
from rastrainer_headless.scene import HeadlessScene
from Testing.domain.scenario.made_up_scenario import ball_head
from Testing.domain.trial import trial_records
from Testing.slicer.host.fixtures import (  # noqa: F401
    fresh_module,
    host,
    lasting_host,
    module_widget,
    start_slicer,
)
from Testing.slicer.simulator_double import SimulatorDouble
from Testing.slicer.training_room import Room


@pytest.fixture
def own_processes():
    """Asked for by tests of what the module does in processes of Slicer's Python."""


@pytest.fixture(autouse=True)
def _work_in_threads(request, monkeypatch):
    """Do such work in a thread, which takes a fraction of the time, unless a test is about it."""
    if "own_processes" not in request.fixturenames:
        monkeypatch.setattr(
            OwnProcess, "__call__", lambda _self, *work, **named: runHere(*work, **named)
        )


@pytest.fixture
def headless_scene():
    return HeadlessScene()


@pytest.fixture
def scene(headless_scene):
    return headless_scene.scene


@pytest.fixture
def work():
    work = BackgroundWork()
    yield work
    work.close()


@pytest.fixture
def room(scene, scenario):
    """The training logic on a link to a simulator double."""
    room = Room(scene, scenario)
    yield room
    room.close()


class Clock:
    """Runs until it is stopped, and jumps where a test adds to `ahead`."""

    def __init__(self):
        self.ahead = 0.0
        self._stands_at = None

    def __call__(self):
        return self.ahead + (time.monotonic() if self._stands_at is None else self._stands_at)

    def stop(self):
        """Stand still: however late a busy machine is, no patience ends."""
        self._stands_at = time.monotonic()

    def skip_ahead(self):
        """Let half a second pass; for conditions that are checked repeatedly."""
        self.ahead += 0.5
        return True


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def link(scene, clock):
    link = Link(scene, headlessKit, clock=clock)
    yield link
    link.disconnect()


@pytest.fixture
def simulator():
    with SimulatorDouble() as double:
        yield double


@pytest.fixture
def scenario(tmp_path):
    """A ball as a head with three tasks on it."""
    write_head_mesh(tmp_path / "head.ply", ball_head())
    names = {"trial-run": "Trial run", "task-1": "Task 1", "task-2": "Task 2"}
    return Scenario(
        format_version=1,
        name="ball",
        title="Ball",
        head=tmp_path / "head.ply",
        target=PlannedTarget("center", np.array([0.0, 10.0, -20.0])),
        head_to_world=transforms.rigid(np.diag([-1.0, -1.0, 1.0]), np.array([500.0, 0.0, 300.0])),
        perturbation=Perturbation(20.0, 10.0, 5.0),
        tasks=tuple(
            make_task(name, title, seed) for seed, (name, title) in enumerate(names.items())
        ),
        cameras={},
        table=None,
        stand=None,
        provenance=None,
        folder=tmp_path,
    )


def make_task(name, title, seed):
    directions = np.random.default_rng(seed).normal(size=(15, 3))
    directions[:, 2] = np.abs(directions[:, 2])
    fiducials = 90.0 * directions / np.linalg.norm(directions, axis=1, keepdims=True)
    return Task(name, title, task_file(name), 1.0 + seed, fiducials=fiducials)


@pytest.fixture
def make_record(scenario):
    """Returns a function that makes the record of a played trial, as JSON."""

    def make(trial_id, task="task-1", seed=1, **changes):
        random = np.random.default_rng(seed)
        touched = transforms.apply(
            scenario.perturbed_head_to_world(seed),
            scenario.task(task).fiducials + random.normal(0.0, 0.7, (15, 3)),
        )
        record = trial_records.make_record(
            trialId=trial_id,
            task=task,
            scenario="ball",
            startedUtc="2026-03-02T09:59:50Z",
            completedUtc="2026-03-02T10:00:20Z",
            completionTimeS=90.0,
            touchRule="on skin",
            motion=dict.fromkeys(SAFETY_METRICS, 0.0) | {"pressing_depth_mm": 0.2},
        )
        for row, (point, place) in enumerate(zip(record["points"], touched.tolist(), strict=True)):
            utc = f"2026-03-02T10:00:{row:02d}Z"
            point.update(positionMm=place, simTimeS=6.0 * (row + 1), utc=utc)
        return record | changes

    return make
