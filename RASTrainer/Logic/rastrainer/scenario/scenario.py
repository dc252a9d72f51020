"""A scenario: a head, its pose, the tasks on it, and the views.

A scenario is a folder with `scenario.json`, the head's mesh, one `.mrk.json` file per task and,
optionally, the images of the head.

A trial that is registered without fiducials belongs to a task all the same: to its number in the
study, and to what is compared with it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.json_fields import Fields, read_fields
from rastrainer.head.mesh import RAS_LIMIT_MM
from rastrainer.head.trial_head import (
    MAX_PERTURBATION,
    UNMOVED,
    Perturbation,
    SkinShift,
    perturbed_pose,
    read_skin,
)
from rastrainer.head.volume import VolumeFile, read_volume_file
from rastrainer.json_checks import IDENTIFIER_WORDS, is_identifier
from rastrainer.procedure.plan import Procedure, read_procedures
from rastrainer.protocol import (
    COARSE_LANDMARKS,
    PLAYED_METHODS,
    WORLD_LIMIT_MM,
    RegistrationMethod,
)
from rastrainer.scenario.points import (
    Landmark,
    PlannedTarget,
    PlannedTrajectory,
    Task,
    read_landmarks,
    read_targets,
    read_task,
    read_trajectory,
)
from rastrainer.transforms import is_rigid

FILE_NAME = "scenario.json"
PREVIEW_NAME = "preview.png"
FORMAT_VERSION = 1
CAMERAS = ("close-up", "far")
MAX_TASKS = 20
STAND_DIAMETERS_MM = (1.0, 500.0)
SKULL_KINDS = ("bone", "approximation")
UNKNOWN_LICENSE = "Not to be shared: its license is unknown."


@dataclass(frozen=True)
class Camera:
    """A view, in World, mm.

    Attributes:
        position: (3,) float, the eye.
        focal_point: (3,) float, the center of the picture.
        view_up: (3,) float, unit vector.
    """

    position: np.ndarray
    focal_point: np.ndarray
    view_up: np.ndarray
    view_angle_deg: float


@dataclass(frozen=True)
class Furniture:
    """What the robot and the head stand on, in World, mm; the table's top is at z = 0.

    Attributes:
        table_center: (2,) float, x and y.
        table_size: (3,) float, along x, along y, thickness.
        stand_diameter: of the round stand from the table to the head's base.
    """

    table_center: np.ndarray
    table_size: np.ndarray
    stand_diameter: float


@dataclass(frozen=True)
class Provenance:
    """The origin of the head.

    Attributes:
        source: the images and their authors.
        method: how the head was made from them.
        license: with the notice that it requires.
    """

    source: str
    method: str
    license: str


@dataclass(frozen=True)
class Scenario:
    """Everything that a trial needs; see the module's description.

    Attributes:
        folder: where it was read from.
        name: short, for records; `title` is for people.
        head_mesh: path of the head's mesh, for `rastrainer.head.mesh.read_head_mesh`.
        target_name: of the point at which the target error is reported, such as the head's center.
        target_position: (3,) float, RAS mm.
        head_to_world: (4, 4) float, rigid, mm: the nominal pose.
        perturbation: how far a trial's pose may be from it.
        tasks: in order of difficulty.
        cameras: by name, "close-up" (the default view) and "far".
        skull_mesh: path of the skull's mesh, or None.
        is_skull_approximate: whether the skull is only estimated from the skin, as from MRI.
        targets: further planned targets.
        trajectory: the planned trajectory, or None.
        volume: the images, or None.
        procedures: planned; a trial may carry one of them out.
        landmarks: by which a trial may be registered without fiducials, in order of touching.
        skin: how the skin lies in trials that do not set it otherwise; each has its own seed.
    """

    folder: Path
    name: str
    title: str
    head_mesh: Path
    target_name: str
    target_position: np.ndarray
    head_to_world: np.ndarray
    perturbation: Perturbation
    tasks: tuple[Task, ...]
    cameras: Mapping[str, Camera]
    furniture: Furniture
    provenance: Provenance
    skull_mesh: Path | None = None
    is_skull_approximate: bool = False
    targets: tuple[PlannedTarget, ...] = ()
    trajectory: PlannedTrajectory | None = None
    volume: VolumeFile | None = None
    procedures: tuple[Procedure, ...] = ()
    landmarks: tuple[Landmark, ...] = ()
    skin: SkinShift = UNMOVED

    @property
    def preview(self) -> Path | None:
        """The picture for lists, or None."""
        path = self.folder / PREVIEW_NAME
        return path if path.is_file() and not path.is_symlink() else None

    def task(self, name: str) -> Task:
        """Return the task of this name."""
        for task in self.tasks:
            if task.name == name:
                return task
        names = ", ".join(task.name for task in self.tasks)
        raise InputError(f"The scenario {self.name} has no such task; it has {names}.")

    def procedure(self, name: str) -> Procedure:
        """Return the procedure of this name."""
        for procedure in self.procedures:
            if procedure.name == name:
                return procedure
        names = ", ".join(procedure.name for procedure in self.procedures) or "none"
        raise InputError(f"The scenario {self.name} has no such procedure; it has {names}.")

    def perturbed_head_to_world(self, seed: int) -> np.ndarray:
        """Return the head's pose in the trial of a seed, (4, 4) float, mm.

        The head is rotated about its target, then moved.
        """
        return perturbed_pose(self.head_to_world, self.target_position, self.perturbation, seed)


def load_scenario(folder: Path | str) -> Scenario:
    """Read a scenario's folder."""
    try:
        return _load(Path(folder))
    except OSError as error:
        raise InputError(f"The scenario {folder} cannot be read: {error.strerror}.") from None


def _load(folder: Path) -> Scenario:
    if not folder.is_dir():
        raise InputError(f"The scenario's folder {folder} does not exist.")
    fields = read_fields(folder / FILE_NAME)
    fields.check_format(FORMAT_VERSION)
    target = fields.fields("target")
    return Scenario(
        folder=folder,
        name=fields.identifier("name"),
        title=fields.text("title", 80),
        head_mesh=fields.file("head"),
        target_name=target.text("name", 60),
        target_position=target.point("positionRas", RAS_LIMIT_MM),
        head_to_world=_rigid(fields, "headToWorld"),
        perturbation=read_perturbation(fields),
        tasks=_tasks(fields),
        cameras={name: _camera(fields.fields("cameras").fields(name)) for name in CAMERAS},
        furniture=_furniture(fields),
        provenance=_provenance(fields.fields("provenance")),
        **_skull(fields),
        targets=read_targets(fields),
        trajectory=read_trajectory(fields),
        volume=read_volume_file(fields),
        procedures=read_procedures(fields),
        landmarks=read_landmarks(fields),
        skin=read_skin(fields),
    )


def _skull(fields: Fields) -> dict[str, Any]:
    if "skull" not in fields.names():
        return {}
    skull = fields.fields("skull")
    kind = skull.one_of("kind", SKULL_KINDS)
    return {"skull_mesh": skull.file("file"), "is_skull_approximate": kind == SKULL_KINDS[1]}


def _tasks(fields: Fields) -> tuple[Task, ...]:
    tasks: dict[str, Task] = {}
    for entry in fields.list_of_fields("tasks", 1, MAX_TASKS):
        name = entry.text("name", 40)
        if not is_identifier(name) or name in tasks:
            raise entry.error("name", f"{IDENTIFIER_WORDS}, each name once")
        title, complexity = entry.text("title", 60), entry.number("complexity", 0, 1000)
        is_measured = "shortestPathMm" in entry.names()
        shortest = entry.number("shortestPathMm", 1, 1e5) if is_measured else None
        tasks[name] = read_task(entry.file("file"), name, title, complexity, shortest)
    return tuple(tasks.values())


def read_perturbation(fields: Fields) -> Perturbation:
    """Return the field `perturbation`."""
    limits = fields.fields("perturbation")
    return Perturbation(
        limits.number("translationMm", 0, MAX_PERTURBATION.translation_mm),
        limits.number("yawDeg", 0, MAX_PERTURBATION.yaw_deg),
        limits.number("tiltDeg", 0, MAX_PERTURBATION.tilt_deg),
    )


def _camera(fields: Fields) -> Camera:
    position, focal_point, up = (
        _array(fields.numbers(name, 3, WORLD_LIMIT_MM))
        for name in ("positionMm", "focalPointMm", "viewUp")
    )
    if np.linalg.norm(np.cross(focal_point - position, up)) < 1e-6:
        raise fields.error("viewUp", "a direction across the line of sight")
    view_up = _array(up / np.linalg.norm(up))
    return Camera(position, focal_point, view_up, fields.number("viewAngleDeg", 1, 120))


def _furniture(fields: Fields) -> Furniture:
    table, stand = fields.fields("table"), fields.fields("stand")
    return Furniture(
        _array(table.numbers("centerMm", 2, WORLD_LIMIT_MM)),
        _array(table.numbers("sizeMm", 3, WORLD_LIMIT_MM)),
        stand.number("diameterMm", *STAND_DIAMETERS_MM),
    )


def _provenance(fields: Fields) -> Provenance:
    return Provenance(*(fields.text(name, 4000) for name in ("source", "method", "license")))


def _rigid(fields: Fields, name: str) -> np.ndarray:
    matrix = _array(fields.numbers(name, 16, WORLD_LIMIT_MM)).reshape(4, 4)
    if not is_rigid(matrix):
        raise fields.error(name, "a rigid transform, 4×4, row by row, in mm")
    return matrix


def _array(values: list[float] | np.ndarray) -> np.ndarray:
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array


def method_of(name: str | None) -> RegistrationMethod:
    """Return the method of a trial by its name; none stands for fiducials."""
    for method in PLAYED_METHODS:
        if method.value == (name or RegistrationMethod.FIDUCIALS.value):
            return method
    names = ", ".join(method.value for method in PLAYED_METHODS)
    raise InputError(f"There is no such registration method; the methods are {names}.")


def playable_methods(scenario: Scenario) -> tuple[RegistrationMethod, ...]:
    """Return the methods by which a trial of a scenario can be played, fiducials first."""
    has_landmarks = len(scenario.landmarks) >= COARSE_LANDMARKS
    return PLAYED_METHODS if has_landmarks else PLAYED_METHODS[:1]


def task_by_method(scenario: Scenario, task_name: str, method: RegistrationMethod) -> Task:
    """Return a task with the points that a method has touched in place of its fiducials."""
    task = scenario.task(task_name)
    if method is RegistrationMethod.FIDUCIALS:
        return task
    landmarks = scenario.landmarks
    if len(landmarks) < COARSE_LANDMARKS:
        raise InputError(
            f"The scenario {scenario.name} has {len(landmarks)} landmarks, and a trial by "
            f"{method.value} needs {COARSE_LANDMARKS}: add them to its scenario.json, or choose "
            "fiducials."
        )
    if method is RegistrationMethod.SURFACE:
        landmarks = landmarks[:COARSE_LANDMARKS]
    places = np.array([landmark.position for landmark in landmarks], dtype=float)
    places.setflags(write=False)
    labels = tuple(landmark.name for landmark in landmarks)
    # The shortest path is that through the fiducials.
    return replace(task, labels=labels, fiducials=places, shortest_path_mm=None)
