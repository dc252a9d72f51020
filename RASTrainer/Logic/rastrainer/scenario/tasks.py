"""The points of a scenario: tasks of fifteen fiducials, landmarks, targets and a trajectory."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.json_fields import Fields
from rastrainer.files.markups import read_markups
from rastrainer.head.mesh import RAS_LIMIT_MM
from rastrainer.protocol import FIDUCIAL_COUNT

LABELS = tuple(str(number) for number in range(1, FIDUCIAL_COUNT + 1))


@dataclass(frozen=True)
class Task:
    """A task for trainees.

    Attributes:
        name: such as "trial-run" or "task-1", for commands and records.
        title: for people.
        labels: "1" to "15", in touch order.
        fiducials: (15, 3) float, RAS mm, in touch order.
        complexity: index from `rastrainer_simulator.authoring.touch_order`.
        shortest_path_mm: from `rastrainer_simulator.authoring.surface_path`, or None.
    """

    name: str
    title: str
    labels: tuple[str, ...]
    fiducials: np.ndarray
    complexity: float
    shortest_path_mm: float | None = None


def read_task(
    path: Path, name: str, title: str, complexity: float, shortest_path_mm: float | None = None
) -> Task:
    """Read a task's fiducials from a `.mrk.json` file.

    Raises:
        InputError: the file is unusable, or does not have fifteen different points labeled "1" to
            "15" in this order.
    """
    points = read_markups(path)
    if tuple(points.labels) != LABELS:
        raise InputError(
            f'{path} must hold {FIDUCIAL_COUNT} points labeled "1" to "{FIDUCIAL_COUNT}", in the '
            "order to touch."
        )
    fiducials = np.array(points.points, dtype=float)
    if not np.all(np.abs(fiducials) <= RAS_LIMIT_MM):
        raise InputError(f"{path} has a point that is not within ±{RAS_LIMIT_MM:g} mm.")
    if len(np.unique(fiducials, axis=0)) != FIDUCIAL_COUNT:
        raise InputError(f"{path} has two points at the same place.")
    fiducials.setflags(write=False)
    return Task(name, title, LABELS, fiducials, complexity, shortest_path_mm)


_NUMBER = re.compile(r"(\d{1,6})\s*$")


def touch_order(labels: Sequence[str]) -> list[int]:
    """Return the rows of a list of fifteen fiducials in touch order.

    The order follows the numbers at the ends of the labels, such as "7" or Slicer's "F-7", or the
    list if there are none.

    Raises:
        InputError: the number of fiducials is wrong, or their numbers are ambiguous.
    """
    if len(labels) != FIDUCIAL_COUNT:
        raise InputError(f"it has {len(labels)} fiducials; a task has {FIDUCIAL_COUNT}.")
    found = [_NUMBER.search(label) for label in labels]
    if not any(found):
        return list(range(FIDUCIAL_COUNT))
    numbers = [int(match.group(1)) for match in found if match]
    if len(set(numbers)) != FIDUCIAL_COUNT:
        raise InputError(
            "some of its labels have no number, or two the same one; number the fiducials from 1 "
            f"to {FIDUCIAL_COUNT} in the order to touch, or none of them."
        )
    return sorted(range(FIDUCIAL_COUNT), key=numbers.__getitem__)


MAX_TARGETS = 20
MIN_TRAJECTORY_MM = 1.0


@dataclass(frozen=True)
class PlannedTarget:
    """A target point, such as a tumor's center.

    Attributes:
        name: for people.
        position: (3,) float, RAS mm.
    """

    name: str
    position: np.ndarray


@dataclass(frozen=True)
class PlannedTrajectory:
    """A straight path into the head.

    Attributes:
        name: for people.
        entry: (3,) float, RAS mm.
        target: (3,) float, RAS mm.
    """

    name: str
    entry: np.ndarray
    target: np.ndarray


def read_targets(fields: Fields) -> tuple[PlannedTarget, ...]:
    """Return the optional field `targets`.

    Raises:
        InputError: it is invalid.
    """
    if "targets" not in fields.names():
        return ()
    entries = fields.list_of_fields("targets", 0, MAX_TARGETS)
    return tuple(
        PlannedTarget(entry.text("name", 60), entry.point("positionRas", RAS_LIMIT_MM))
        for entry in entries
    )


def read_trajectory(fields: Fields) -> PlannedTrajectory | None:
    """Return the optional field `trajectory`.

    Raises:
        InputError: it is invalid.
    """
    if "trajectory" not in fields.names():
        return None
    own = fields.fields("trajectory")
    entry, target = (own.point(end, RAS_LIMIT_MM) for end in ("entryRas", "targetRas"))
    if np.linalg.norm(target - entry) < MIN_TRAJECTORY_MM:
        raise own.error("entryRas", f"at least {MIN_TRAJECTORY_MM:g} mm from targetRas")
    return PlannedTrajectory(own.text("name", 60), entry, target)


MAX_LANDMARKS = 15


@dataclass(frozen=True)
class Landmark:
    """A landmark.

    Attributes:
        name: such as "Nasion", by which it is asked for.
        position: (3,) float, RAS mm.
    """

    name: str
    position: np.ndarray


def read_landmarks(fields: Fields) -> tuple[Landmark, ...]:
    """Return the optional field `landmarks` of a scenario, in the order of touching.

    Raises:
        InputError: it is invalid.
    """
    if "landmarks" not in fields.names():
        return ()
    landmarks: dict[str, Landmark] = {}
    for entry in fields.list_of_fields("landmarks", 0, MAX_LANDMARKS):
        name = entry.text("name", 40)
        if name in landmarks:
            raise entry.error("name", "another name than that of each landmark before")
        landmarks[name] = Landmark(name, entry.point("positionRas", RAS_LIMIT_MM))
    return tuple(landmarks.values())
