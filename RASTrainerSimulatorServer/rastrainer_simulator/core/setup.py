"""The scenario, the robot and the settings of a simulation."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.journal.entries import JournalHeader, RecordedContent, RecordedMethod
from rastrainer.json_records import record_to_json
from rastrainer.protocol import RegistrationMethod
from rastrainer.scenario.scenario import FILE_NAME, Scenario, load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.collision.robot_shape import RobotShape, load_shape
from rastrainer_simulator.core.settings import SimulationSettings
from rastrainer_simulator.robot.model import RobotModel, load_robot

DEFAULT_SCENARIO = ("scenarios", "colin27")
_LEFT_OUT = ("volume", "skull", "procedures", "landmarks")


@dataclass(frozen=True)
class SimulationSetup:
    """Everything that a simulation starts from, besides its seed.

    The hashes identify in a journal what a trial depends on; only trials by landmarks or with a
    procedure depend on `landmarks_sha256` or `procedure_sha256` (by its name), too.
    """

    scenario: Scenario
    robot: RobotModel
    shape: RobotShape
    settings: SimulationSettings = field(default_factory=SimulationSettings)
    scenario_sha256: str = ""
    landmarks_sha256: str = ""
    procedure_sha256: Mapping[str, str] = field(default_factory=dict)

    def recorded(
        self, procedure: str = "", method: RegistrationMethod = RegistrationMethod.FIDUCIALS
    ) -> dict[str, Any]:
        """Return the part of a trial's `JournalHeader` that identifies this setup."""
        by_landmarks = method is not RegistrationMethod.FIDUCIALS
        sha256 = self.procedure_sha256.get(procedure, "")
        return {
            "scenario": RecordedContent(self.scenario.name, self.scenario_sha256),
            "robot": self.robot.name,
            "settings": record_to_json(self.settings, with_defaults=True),
            "procedure": RecordedContent(procedure, sha256) if procedure else None,
            "method": RecordedMethod(method, self.landmarks_sha256) if by_landmarks else None,
        }

    def difference(self, recorded: JournalHeader) -> str:
        """Return what a trial was recorded with that is not the same here, "" for nothing."""
        procedure, method = recorded.procedure, recorded.method
        if recorded.scenario.sha256 != self.scenario_sha256:
            return "scenario"
        if method is not None and method.landmarks_sha256 != self.landmarks_sha256:
            return "landmarks"
        if procedure and self.procedure_sha256.get(procedure.name) != procedure.sha256:
            return "procedure"
        return "" if recorded.robot == self.robot.name else "robot"


def load_setup(
    scenario_folder: Path | None = None,
    settings: SimulationSettings | None = None,
    robot_meshes: Path | None = None,
) -> SimulationSetup:
    """Load a scenario and a robot; by default those that come with RASTrainer."""
    scenario = load_scenario(scenario_folder or asset_path(*DEFAULT_SCENARIO))
    robot = load_robot(robot_meshes)
    return SimulationSetup(
        scenario=scenario,
        robot=robot,
        shape=load_shape(),
        settings=settings or SimulationSettings(),
        scenario_sha256=scenario_sha256(scenario),
        landmarks_sha256=landmarks_sha256(scenario),
        procedure_sha256={
            procedure.name: procedure.sha256(scenario.skull_path)
            for procedure in scenario.procedures
        },
    )


def scenario_sha256(scenario: Scenario) -> str:
    """Return one hash of what a trial of touches depends on: `scenario.json`, head and fiducials.

    It excludes the parts that may be added to a scenario with recorded trials: the volume, which
    the simulator never reads, landmarks, skull and procedures.
    """
    content = (scenario.folder / FILE_NAME).read_bytes()
    values = json.loads(content)
    kept = {name: values[name] for name in values if name not in _LEFT_OUT}
    if kept != values:
        content = (json.dumps(kept, indent=2, ensure_ascii=False) + "\n").encode()
    whole = hashlib.sha256()
    for each in (content, scenario.head.read_bytes()):
        whole.update(hashlib.sha256(each).digest())
    for task in scenario.tasks:
        whole.update(task.name.encode() + task.fiducials.astype("<f8").tobytes())
    return whole.hexdigest()


def landmarks_sha256(scenario: Scenario) -> str:
    """Return one hash of a scenario's landmarks: names and positions, in their order."""
    whole = hashlib.sha256()
    for landmark in scenario.landmarks:
        name = json.dumps(landmark.name).encode()
        whole.update(name + np.asarray(landmark.position_ras, dtype="<f8").tobytes())
    return whole.hexdigest()
