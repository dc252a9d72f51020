"""A scenario: a head, its pose, the tasks on it, and the views.

A scenario is a folder with `scenario.json`, the head's mesh, one `.mrk.json` file per task and,
optionally, the images of the head.

A trial that is registered without fiducials also belongs to a task: to its number in the study, and
to the trials it is compared with.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.reading import format_version, path_beside, read_record, relative_path
from rastrainer.head.trial_head import UNMOVED, Perturbation, SkinShift, perturbed_pose
from rastrainer.head.volume import VolumeFile
from rastrainer.json_checks import identifier, list_of, number, numbers, point, text
from rastrainer.json_records import NOT_IN_JSON
from rastrainer.procedure import plan
from rastrainer.protocol import (
    COARSE_LANDMARKS,
    PLAYED_METHODS,
    SKIN_KEYS,
    WORLD_LIMIT_MM,
    RegistrationMethod,
)
from rastrainer.scenario import points
from rastrainer.transforms import is_rigid

FILE_NAME = "scenario.json"
PREVIEW_NAME = "preview.png"
FORMAT_VERSION = 1
CAMERAS = ("close-up", "far")
MAX_TASKS = 20
STAND_DIAMETERS_MM = (1.0, 500.0)
UNKNOWN_LICENSE = "Not to be shared: its license is unknown."


class SkullKind(str, Enum):
    """The origin of a skull; an approximation is estimated from the skin, as from MRI."""

    BONE = "bone"
    APPROXIMATION = "approximation"


def _rigid(value: Any) -> np.ndarray:
    matrix = np.reshape(numbers(16, WORLD_LIMIT_MM)(value), (4, 4))
    if not is_rigid(matrix):
        raise ValueError("a rigid transform, 4×4, row by row, in mm")
    matrix.setflags(write=False)
    return matrix


def _unit_vector(value: Any) -> np.ndarray:
    vector = np.array(numbers(3, WORLD_LIMIT_MM)(value))
    vector /= np.linalg.norm(vector) or 1.0
    vector.setflags(write=False)
    return vector


def _all_cameras(value: Any) -> Any:
    if not isinstance(value, Mapping) or not value.keys() >= set(CAMERAS):
        raise ValueError(f"an object of {' and '.join(CAMERAS)}")
    return {name: value[name] for name in CAMERAS}


def _amounts_of_skin(value: Any) -> Any:
    """Accept a skin without a seed: each trial has its own."""
    if not isinstance(value, Mapping) or not set(value) <= set(SKIN_KEYS):
        raise ValueError(f"an object of {' and '.join(SKIN_KEYS)}")
    return value


@dataclass(frozen=True)
class Camera:
    """A view, in World, (3,) float each: the eye, the picture's center, and a unit vector."""

    position_mm: Annotated[np.ndarray, point(WORLD_LIMIT_MM)]
    focal_point_mm: Annotated[np.ndarray, point(WORLD_LIMIT_MM)]
    view_up: Annotated[np.ndarray, _unit_vector]
    view_angle_deg: Annotated[float, number(1, 120)]


@dataclass(frozen=True)
class OperatingTable:
    """The table, in World; its top is at z = 0. Its size is along x, along y, and its thickness."""

    center_mm: Annotated[tuple[float, ...], numbers(2, WORLD_LIMIT_MM)]
    size_mm: Annotated[tuple[float, ...], numbers(3, WORLD_LIMIT_MM)]


@dataclass(frozen=True)
class Stand:
    """The round stand from the table to the head's base."""

    diameter_mm: Annotated[float, number(*STAND_DIAMETERS_MM)]


@dataclass(frozen=True)
class Provenance:
    """The origin of the head: images and authors, how it was made, license and its notice."""

    source: Annotated[str, text(4000)]
    method: Annotated[str, text(4000)]
    license: Annotated[str, text(4000)]


@dataclass(frozen=True)
class SkullFile:
    """The mesh of a skull."""

    file: Annotated[Path, relative_path]
    kind: SkullKind


@dataclass(frozen=True)
class Scenario:
    """Everything that a trial needs, as `scenario.json` has it; see the module's description.

    Paths are relative to the scenario's folder in the file, and whole when it was loaded.

    Attributes:
        name: short, for records; `title` is for people.
        head: path of the head's mesh, for `rastrainer.head.mesh.read_head_mesh`.
        target: the point at which the target error is reported, such as the head's center.
        head_to_world: (4, 4) float, rigid, mm: the nominal pose.
        perturbation: how far a trial's pose may be from it.
        tasks: in order of difficulty.
        cameras: by name, "close-up" (the default view) and "far".
        landmarks: by which a trial may be registered without fiducials, in order of touching.
        skin: how the skin lies in trials that do not set it otherwise; each has its own seed.
        procedures: planned; a trial may carry one of them out.
    """

    format_version: Annotated[int, format_version(FORMAT_VERSION)]
    name: Annotated[str, identifier]
    title: Annotated[str, text(80)]
    head: Annotated[Path, relative_path]
    target: points.PlannedTarget
    head_to_world: Annotated[np.ndarray, _rigid]
    perturbation: Perturbation
    tasks: Annotated[tuple[points.Task, ...], plan.named_once(1, MAX_TASKS)]
    cameras: Annotated[Mapping[str, Camera], _all_cameras]
    table: OperatingTable
    stand: Stand
    provenance: Provenance
    skull: SkullFile | None = None
    volume: VolumeFile | None = None
    targets: Annotated[
        tuple[points.PlannedTarget, ...], list_of(0, points.MAX_TARGETS, "objects")
    ] = ()
    trajectory: points.PlannedTrajectory | None = None
    landmarks: Annotated[tuple[points.Landmark, ...], plan.named_once(0, points.MAX_LANDMARKS)] = ()
    skin: Annotated[SkinShift, _amounts_of_skin] = UNMOVED
    procedures: Annotated[tuple[plan.Procedure, ...], plan.named_once(0, plan.MAX_PROCEDURES)] = ()
    folder: Path = field(default=Path(), metadata=NOT_IN_JSON)

    @property
    def preview(self) -> Path | None:
        path = self.folder / PREVIEW_NAME
        return path if path.is_file() and not path.is_symlink() else None

    @property
    def skull_path(self) -> Path:
        assert self.skull is not None, "a scenario with procedures has a skull"
        return self.skull.file

    def task(self, name: str) -> points.Task:
        for task in self.tasks:
            if task.name == name:
                return task
        names = ", ".join(task.name for task in self.tasks)
        raise InputError(f"The scenario {self.name} has no such task; it has {names}.")

    def procedure(self, name: str) -> plan.Procedure:
        for procedure in self.procedures:
            if procedure.name == name:
                return procedure
        names = ", ".join(procedure.name for procedure in self.procedures) or "none"
        raise InputError(f"The scenario {self.name} has no such procedure; it has {names}.")

    def perturbed_head_to_world(self, seed: int) -> np.ndarray:
        """Return the head's pose in the trial of a seed, (4, 4) float, mm.

        The head is rotated about its target, then moved.
        """
        return perturbed_pose(self.head_to_world, self.target.position_ras, self.perturbation, seed)


def load_scenario(folder: Path | str) -> Scenario:
    try:
        return _load(Path(folder))
    except OSError as error:
        raise InputError(f"The scenario {folder} cannot be read: {error.strerror}.") from None


def _load(folder: Path) -> Scenario:
    if not folder.is_dir():
        raise InputError(f"The scenario's folder {folder} does not exist.")
    path = folder / FILE_NAME
    read = read_record(Scenario, path)
    _check_fields(read, path)
    tasks = (
        replace(
            each,
            fiducials=points.read_fiducials(path_beside(path, each.file, f"tasks[{index}].file")),
        )
        for index, each in enumerate(read.tasks)
    )
    procedures = (
        plan.located(procedure, path, f"procedures[{index}].")
        for index, procedure in enumerate(read.procedures)
    )
    skull, volume = read.skull, read.volume
    return replace(
        read,
        folder=folder,
        head=path_beside(path, read.head, "head"),
        tasks=tuple(tasks),
        skull=skull and replace(skull, file=path_beside(path, skull.file, "skull.file")),
        volume=volume and volume.located(path),
        procedures=tuple(procedures),
    )


def _check_fields(scenario: Scenario, path: Path) -> None:
    wrong = ""
    for name, camera in scenario.cameras.items():
        sight = camera.focal_point_mm - camera.position_mm
        if np.linalg.norm(np.cross(sight, camera.view_up)) < 1e-6:
            wrong = f"cameras.{name}.viewUp must be a direction across the line of sight"
    line = scenario.trajectory
    if line and np.linalg.norm(line.target_ras - line.entry_ras) < points.MIN_TRAJECTORY_MM:
        wrong = (
            f"trajectory.entryRas must be at least {points.MIN_TRAJECTORY_MM:g} mm from targetRas"
        )
    if scenario.procedures and scenario.skull is None:
        wrong = (
            "skull must be given, because the scenario has procedures, and drilling needs a skull"
        )
    no_go = {each.file for procedure in scenario.procedures for each in procedure.no_go}
    if len(no_go) > plan.MAX_NO_GO_FILES:
        wrong = f"procedures must be with at most {plan.MAX_NO_GO_FILES} files of no-go meshes"
    if wrong:
        raise InputError(f"{path}: {wrong}.")


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


def task_by_method(scenario: Scenario, task_name: str, method: RegistrationMethod) -> points.Task:
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
    places = np.array([landmark.position_ras for landmark in landmarks], dtype=float)
    places.setflags(write=False)
    labels = tuple(landmark.name for landmark in landmarks)
    # The shortest path is that through the fiducials.
    return replace(task, labels=labels, fiducials=places, shortest_path_mm=None)
