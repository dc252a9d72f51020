"""What the simulator's tests share."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer.head_mesh import read_head_mesh
from rastrainer.scenario import Camera, Furniture, Perturbation, Provenance, Scenario
from rastrainer.tasks import LABELS, Task
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.robot.model import load_robot
from rastrainer_simulator.setup import SimulationSetup
from rastrainer_simulator.simulation import Simulation


@pytest.fixture(scope="session")
def scenario():
    path = asset_path("scenarios", "colin27", "head.ply")
    mesh = read_head_mesh(path)
    random = np.random.default_rng(0)
    front = (mesh.vertices[:, 2] > 20) & (mesh.vertices[:, 0] > 0)
    tasks = tuple(
        Task(name, name, LABELS, mesh.vertices[random.choice(np.flatnonzero(front), 15)], 1.0)
        for name in ("trial-run", "task-1", "task-2")
    )
    nominal = np.array([[-1.0, 0, 0, 500], [0, -1, 0, 0], [0, 0, 1, 300], [0, 0, 0, 1]])
    camera = Camera(
        np.array([500.0, -800, 450]), np.array([500.0, 0, 300]), np.array([0.0, 0, 1]), 30.0
    )
    return Scenario(
        path.parent,
        "stand",
        "Stand-in",
        path,
        "center",
        np.array([0.0, -18, 16]),
        nominal,
        Perturbation(10.0, 10.0, 5.0),
        tasks,
        {"close-up": camera, "far": camera},
        Furniture(np.zeros(2), np.ones(3), 80.0),
        Provenance("", "", ""),
    )


@pytest.fixture(scope="session")
def setup(scenario):
    return SimulationSetup(scenario, load_robot())


@pytest.fixture(scope="session")
def shared_simulation(setup):
    return Simulation(setup, 1)
