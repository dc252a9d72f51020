"""What a simulation is made from: the scenario, the robot and the settings.

The packages that read URDF and meshes take a second to import and 90 MB. A prepared robot (its
model and shape as JSON beside the URDF, exact to the last bit) is loaded without them.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer.protocol import RegistrationMethod
from rastrainer.scenario.scenario import FILE_NAME, Scenario, load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.collision.robot_shape import Capsule, LinkShape, RobotShape, robot_shape
from rastrainer_simulator.core.settings import SimulationSettings
from rastrainer_simulator.robot.model import (
    DEFAULT_URDF,
    MeshPart,
    RobotLink,
    RobotModel,
    load_robot,
    make_model,
    mesh_inside,
)
from rastrainer_simulator.robot.srs_arm import Joint

PREPARED_NAME = "prepared.json"
MAX_BYTES = 2**20


def read_prepared(urdf: Path) -> Mapping[str, Any] | None:
    """Return the prepared robot beside a URDF, None if there is none or it is out of date."""
    try:
        prepared = read_json(urdf.parent / PREPARED_NAME, MAX_BYTES)
        return prepared if prepared["sha256"] == _fingerprint(urdf) else None
    except (InputError, OSError, KeyError, TypeError):
        return None


def write_prepared(urdf: Path, model: Mapping[str, Any], shape: Mapping[str, Any]) -> None:
    """Write the JSON of a robot's model and shape beside its URDF."""
    prepared = {"sha256": _fingerprint(urdf), "model": model, "shape": shape}
    text = json.dumps(prepared, indent=1, sort_keys=True) + "\n"
    (urdf.parent / PREPARED_NAME).write_text(text, encoding="utf-8", newline="\n")


def _fingerprint(urdf: Path) -> str:
    """Return a hash of the URDF and of everything below its folder's `meshes/collision`."""
    whole = hashlib.sha256(urdf.read_bytes())
    for path in sorted((urdf.parent / "meshes" / "collision").glob("*")):
        whole.update(path.name.encode() + hashlib.sha256(path.read_bytes()).digest())
    return whole.hexdigest()


def model_to_json(model: RobotModel, folder: Path) -> dict[str, Any]:
    """Return a model as a JSON object; its mesh files are named from `folder` on."""
    meshes = [asdict(part) | {"path": part.path.relative_to(folder)} for part in model.meshes]
    return _plain(
        {
            "name": model.name,
            "tip": model.tip.name,
            "joints": [asdict(joint) for joint in model.joints],
            "links": [asdict(link) for link in model.links],
            "meshes": meshes,
        }
    )


def model_from_json(value: Mapping[str, Any], folder: Path) -> RobotModel:
    """Return the model that a JSON object holds; its mesh files are below `folder`."""
    joints = tuple(Joint(**_arrays(joint, "origin", "axis")) for joint in value["joints"])
    links = tuple(RobotLink(**_arrays(link, "offset")) for link in value["links"])
    meshes = tuple(
        MeshPart(
            **_arrays(part, "origin")
            | {"path": mesh_inside(folder, folder / part["path"], part["link"])}
            | {name: tuple(part[name]) for name in ("scale", "color")}
        )
        for part in value["meshes"]
    )
    return make_model(value["name"], joints, links, value["tip"], meshes)


def _plain(value: Any) -> Any:
    """Return a value ready for JSON: arrays as lists, paths as text."""
    if isinstance(value, dict):
        return {name: _plain(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    if isinstance(value, np.ndarray):
        return value.tolist()
    return value.as_posix() if isinstance(value, Path) else value


def _arrays(value: Mapping[str, Any], *names: str) -> dict[str, Any]:
    arrays = {name: np.array(value[name]) for name in names}
    for array in arrays.values():
        array.setflags(write=False)
    return {**value, **arrays}


def shape_to_json(shape: RobotShape) -> dict[str, Any]:
    links = [asdict(link) for link in shape.links]
    return _plain({"links": links, "tool": asdict(shape.tool), "tipName": shape.tip_name})


def shape_from_json(value: Mapping[str, Any]) -> RobotShape:
    """Return the shape that a JSON object holds."""
    links = tuple(_link_from_json(link) for link in value["links"])
    return RobotShape(links, _link_from_json(value["tool"]), value["tipName"])


def _link_from_json(value: Mapping[str, Any]) -> LinkShape:
    capsules = tuple(
        Capsule(np.array(found["start"]), np.array(found["end"]), found["radius"])
        for found in value["capsules"]
    )
    return LinkShape(value["name"], value["joint"], capsules)


DEFAULT_SCENARIO = ("scenarios", "colin27")


@dataclass(frozen=True)
class RecordedContent:
    """Name and hash of a scenario or a procedure."""

    name: str
    sha256: str


@dataclass(frozen=True)
class RecordedMethod:
    """The method of a trial without fiducials, and the hash of the scenario's landmarks."""

    name: str
    landmarks_sha256: str


@dataclass(frozen=True)
class RecordedSetup:
    """What identifies a setup in the header of a journal."""

    scenario: RecordedContent
    robot: str
    settings: SimulationSettings
    procedure: RecordedContent | None = None
    method: RecordedMethod | None = None


@dataclass(frozen=True)
class SimulationSetup:
    """Everything that a simulation starts from, besides its seed.

    The hashes are of what a trial depends on, which identifies it in a journal; those of landmarks
    and of procedures, by name, are of what such a trial depends on besides.
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
    ) -> RecordedSetup:
        """Return what identifies this setup in the journal of a trial."""
        by_landmarks = method is not RegistrationMethod.FIDUCIALS
        return RecordedSetup(
            RecordedContent(self.scenario.name, self.scenario_sha256),
            self.robot.name,
            self.settings,
            RecordedContent(procedure, self.procedure_sha256.get(procedure, ""))
            if procedure
            else None,
            RecordedMethod(method.value, self.landmarks_sha256) if by_landmarks else None,
        )

    def difference(self, recorded: RecordedSetup) -> str:
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
    urdf_path: Path | None = None,
    robot_meshes: Path | None = None,
) -> SimulationSetup:
    """Load a scenario and a robot; by default those that come with RASTrainer."""
    folder = scenario_folder or asset_path(*DEFAULT_SCENARIO)
    scenario = load_scenario(folder)
    path = urdf_path or asset_path(*DEFAULT_URDF)
    prepared = read_prepared(path) if robot_meshes is None else None
    if prepared is None:
        robot = load_robot(path, robot_meshes)
        shape = robot_shape(robot)
    else:
        robot = model_from_json(prepared["model"], path.parent)
        shape = shape_from_json(prepared["shape"])
    return SimulationSetup(
        scenario=scenario,
        robot=robot,
        shape=shape,
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

    It excludes what may be added to a scenario with recorded trials: the volume, which the
    simulator never reads, landmarks, skull and procedures. A trial with a procedure, or by
    landmarks, has a hash of its own (`Procedure.sha256`, `landmarks_sha256`) in its journal.
    """
    left_out = ["volume", "skull", "procedures", "landmarks"]
    whole = hashlib.sha256()
    for content in (
        _without(scenario.folder / FILE_NAME, left_out),
        scenario.head.read_bytes(),
    ):
        whole.update(hashlib.sha256(content).digest())
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


def _without(path: Path, names: list[str]) -> bytes:
    """Return a `scenario.json` as it would be written without some fields."""
    content = path.read_bytes()
    values = json.loads(content)
    if not any(name in values for name in names):
        return content
    kept = {name: value for name, value in values.items() if name not in names}
    return (json.dumps(kept, indent=2, ensure_ascii=False) + "\n").encode()
