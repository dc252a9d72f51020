"""The points of a scenario: tasks of fifteen fiducials, planned targets and a trajectory."""

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
_NAME = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")


@dataclass(frozen=True)
class Task:
    """What a trainee has to touch.

    Attributes:
        name: such as "trial-run" or "task-1"; commands and records use it.
        title: what people read.
        labels: "1" to "15", in the order to touch.
        fiducials: (15, 3) float, RAS mm, in that order.
        complexity: the index of `rastrainer.scenario.complexity`.
        shortest_path_mm: of `rastrainer.head.surface_path`; None where it was not measured.
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
        InputError: the file cannot be used, or does not hold fifteen different points that are
            labeled "1" to "15" in this order.
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


def is_task_name(name: str) -> bool:
    """Return whether a name can stand in commands and file names: lower case, digits, hyphens."""
    return len(name) <= 40 and _NAME.fullmatch(name) is not None


_NUMBER = re.compile(r"(\d{1,6})\s*$")


def touch_order(labels: Sequence[str]) -> list[int]:
    """Return the rows of a list of fifteen fiducials in the order to touch them.

    Numbers at the ends of the labels, such as "7" or Slicer's own "F-7", are the order; without
    any, it is the list's.

    Raises:
        InputError: there are more or fewer fiducials, or their numbers are no order.
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
    """A point to be reached, such as a tumor's center.

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
        entry: (3,) float, RAS mm, where it enters.
        target: (3,) float, RAS mm, where it ends.
    """

    name: str
    entry: np.ndarray
    target: np.ndarray


def read_targets(fields: Fields) -> tuple[PlannedTarget, ...]:
    """Return the optional field `targets`.

    Raises:
        InputError: it is there and cannot be used.
    """
    if "targets" not in fields.names():
        return ()
    entries = fields.list_of_fields("targets", 0, MAX_TARGETS)
    return tuple(
        PlannedTarget(entry.text("name", 60), _point(entry, "positionRas")) for entry in entries
    )


def read_trajectory(fields: Fields) -> PlannedTrajectory | None:
    """Return the optional field `trajectory`.

    Raises:
        InputError: it is there and cannot be used.
    """
    if "trajectory" not in fields.names():
        return None
    own = fields.fields("trajectory")
    entry, target = _point(own, "entryRas"), _point(own, "targetRas")
    if np.linalg.norm(target - entry) < MIN_TRAJECTORY_MM:
        raise own.error("entryRas", f"at least {MIN_TRAJECTORY_MM:g} mm from targetRas")
    return PlannedTrajectory(own.text("name", 60), entry, target)


def _point(fields: Fields, name: str) -> np.ndarray:
    point = np.array(fields.numbers(name, 3, RAS_LIMIT_MM), dtype=float)
    point.setflags(write=False)
    return point
