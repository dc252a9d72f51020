"""What a simulation is made from: the scenario, the robot and the settings."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rastrainer.scenario.scenario import FILE_NAME, Scenario, load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.collision.robot_shape import RobotShape, robot_shape
from rastrainer_simulator.core.prepared_robot import model_from_json, read_prepared, shape_from_json
from rastrainer_simulator.core.settings import SimulationSettings, settings_to_json
from rastrainer_simulator.robot.model import DEFAULT_URDF, RobotModel, load_robot

DEFAULT_SCENARIO = ("scenarios", "colin27")


@dataclass(frozen=True)
class SimulationSetup:
    """Everything that a simulation starts from, besides its seed.

    Attributes:
        scenario: head, tasks and cameras.
        robot: the arm and its tool.
        shape: the arm and its tool as collisions see them.
        settings: how it behaves.
        scenario_sha256: of what a trial depends on, so that a journal tells which it was.
    """

    scenario: Scenario
    robot: RobotModel
    shape: RobotShape
    settings: SimulationSettings = field(default_factory=SimulationSettings)
    scenario_sha256: str = ""

    def description(self) -> dict[str, Any]:
        """Return what a journal's header tells of it, ready for JSON."""
        return {
            "scenario": {"name": self.scenario.name, "sha256": self.scenario_sha256},
            "robot": self.robot.name,
            "settings": settings_to_json(self.settings),
        }


def load_setup(
    scenario_folder: Path | None = None,
    settings: SimulationSettings | None = None,
    urdf_path: Path | None = None,
    robot_meshes: Path | None = None,
) -> SimulationSetup:
    """Load a scenario and a robot; by default those that come with RASTrainer.

    Raises:
        InputError: a file of theirs cannot be used.
    """
    folder = scenario_folder or asset_path(*DEFAULT_SCENARIO)
    scenario = load_scenario(folder)
    robot, shape = _robot_and_shape(urdf_path, robot_meshes)
    return SimulationSetup(
        scenario=scenario,
        robot=robot,
        shape=shape,
        settings=settings or SimulationSettings(),
        scenario_sha256=scenario_sha256(scenario),
    )


def _robot_and_shape(
    urdf_path: Path | None, robot_meshes: Path | None
) -> tuple[RobotModel, RobotShape]:
    path = urdf_path or asset_path(*DEFAULT_URDF)
    prepared = read_prepared(path) if robot_meshes is None else None
    if prepared is None:
        robot = load_robot(path, robot_meshes)
        return robot, robot_shape(robot)
    return model_from_json(prepared["model"], path.parent), shape_from_json(prepared["shape"])


def scenario_sha256(scenario: Scenario) -> str:
    """Return one hash of what a trial depends on: `scenario.json`, the head and the fiducials.

    The volume, which the simulator never reads, is none of it: journals that were recorded before
    a scenario had one stay its own.
    """
    whole = hashlib.sha256()
    for content in (_without_volume(scenario.folder / FILE_NAME), scenario.head_mesh.read_bytes()):
        whole.update(hashlib.sha256(content).digest())
    for task in scenario.tasks:
        whole.update(task.name.encode() + task.fiducials.astype("<f8").tobytes())
    return whole.hexdigest()


def _without_volume(path: Path) -> bytes:
    """Return a `scenario.json` as it would be written without its volume."""
    content = path.read_bytes()
    values = json.loads(content)
    if values.pop("volume", None) is None:
        return content
    return (json.dumps(values, indent=2, ensure_ascii=False) + "\n").encode()
