"""The points of a scenario: tasks of fifteen fiducials, targets, a trajectory, landmarks.

Landmarks are checked for their number, their distance to the skin, their side and their spread.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations
from pathlib import Path
from typing import Annotated

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.point_files import read_markups
from rastrainer.files.reading import relative_path
from rastrainer.head.mesh import RAS_LIMIT_MM, HeadMesh, nearest_on_mesh
from rastrainer.json_checks import identifier, number, point, text
from rastrainer.json_records import NOT_IN_JSON
from rastrainer.protocol import COARSE_LANDMARKS, FIDUCIAL_COUNT

LABELS = tuple(str(number) for number in range(1, FIDUCIAL_COUNT + 1))


@dataclass(frozen=True)
class Task:
    """A task for trainees, as in `scenario.json`, and its fiducials from a separate file.

    The name, such as "trial-run" or "task-1", is for commands and records. Complexity and shortest
    path are from `rastrainer_simulator.authoring.touch_order`. Labels, "1" to "15", and fiducials,
    (15, 3) float, RAS mm, are in touch order.
    """

    name: Annotated[str, identifier]
    title: Annotated[str, text(60)]
    file: Annotated[Path, relative_path]
    complexity: Annotated[float, number(0, 1000)]
    shortest_path_mm: Annotated[float | None, number(1, 1e5)] = None
    labels: tuple[str, ...] = field(default=LABELS, metadata=NOT_IN_JSON)
    fiducials: np.ndarray = field(default_factory=lambda: np.empty((0, 3)), metadata=NOT_IN_JSON)


def task_file(name: str) -> Path:
    """Return the place of a task's fiducials in the folder of its scenario."""
    return Path(f"tasks/{name}.mrk.json")


def read_fiducials(path: Path) -> np.ndarray:
    """Return a task's fiducials, (15, 3) float, RAS mm, read-only, from a `.mrk.json` file."""
    points = read_markups(path)
    if tuple(points.labels) != LABELS:
        raise InputError(
            f'{path} must hold {FIDUCIAL_COUNT} points labeled "1" to "{FIDUCIAL_COUNT}", in the '
            "order to touch."
        )
    if not np.all(np.abs(points.points) <= RAS_LIMIT_MM):
        raise InputError(f"{path} has a point that is not within ±{RAS_LIMIT_MM:g} mm.")
    if len(np.unique(points.points, axis=0)) != FIDUCIAL_COUNT:
        raise InputError(f"{path} has two points at the same place.")
    return points.points


_NUMBER = re.compile(r"(\d{1,6})\s*$")


def touch_order(labels: Sequence[str]) -> list[int]:
    """Return the rows of a list of fifteen fiducials in touch order.

    The order follows the numbers at the ends of the labels, such as "7" or Slicer's "F-7", or the
    list if there are none.
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


MAX_TARGETS, MAX_LANDMARKS = 20, 15
MIN_TRAJECTORY_MM = 1.0
_Point = Annotated[np.ndarray, point(RAS_LIMIT_MM)]


@dataclass(frozen=True)
class PlannedTarget:
    """A target point, such as a tumor's center; `position_ras` (3,) float, mm."""

    name: Annotated[str, text(60)]
    position_ras: _Point


@dataclass(frozen=True)
class PlannedTrajectory:
    """A straight path into the head; `entry_ras` and `target_ras` (3,) float, mm."""

    name: Annotated[str, text(60)]
    entry_ras: _Point
    target_ras: _Point


@dataclass(frozen=True)
class Landmark:
    """A landmark, asked for by its name, such as "Nasion"; `position_ras` (3,) float, mm."""

    name: Annotated[str, text(40)]
    position_ras: _Point


NASION, NOSE_TIP = "Nasion", "Tip of the nose"
FACE_LANDMARKS = (
    NASION,
    "Right outer canthus",
    "Left outer canthus",
    "Right inner canthus",
    "Left inner canthus",
    "Right tragus",
    "Left tragus",
    NOSE_TIP,
)
"""The usual landmarks; right and left are the patient's."""
SNAP_MM = 5.0
"""A landmark nearer to the skin than this is moved onto it; one farther off is wrong."""
APART_MM = 10.0
"""Least distance of two landmarks."""
LEAST_SPREAD_MM = 15.0
"""Least distance of the first three landmarks from the line that fits them best, RMS times √3."""
ASIDE_MM = 3.0
"""How far a landmark of one side may be beyond the middle of the head."""
_SIDES = {"right": 1.0, "left": -1.0}
_OTHER = {"right": "left", "left": "right"}


def on_skin(mesh: HeadMesh, landmarks: Sequence[Landmark]) -> tuple[Landmark, ...]:
    """Return landmarks with those near the skin moved onto it; others stay where they are."""
    moved = []
    for landmark in landmarks:
        nearest = nearest_on_mesh(mesh, landmark.position_ras)
        is_near = nearest.distance <= SNAP_MM
        place = nearest.position.round(2) if is_near else landmark.position_ras
        moved.append(Landmark(landmark.name, place))
    return tuple(moved)


def check_landmarks(mesh: HeadMesh, landmarks: Sequence[Landmark]) -> list[str]:
    """Return a sentence for each thing that is wrong with the landmarks of a head."""
    if not COARSE_LANDMARKS <= len(landmarks) <= MAX_LANDMARKS:
        return [
            f"The head has {len(landmarks)} landmarks; place {COARSE_LANDMARKS} to "
            f"{MAX_LANDMARKS} of them."
        ]
    names = [landmark.name for landmark in landmarks]
    twice = [name for name in dict.fromkeys(names) if names.count(name) > 1]
    wrong = [f"{name} is placed {names.count(name)} times; keep one." for name in twice]
    for landmark in landmarks:
        away = nearest_on_mesh(mesh, landmark.position_ras).distance
        if away > SNAP_MM:
            wrong.append(
                f"{landmark.name} is {away:.0f} mm off the skin; place it within {SNAP_MM:g} mm."
            )
    wrong += _on_other_side(mesh, landmarks)
    for one, other in combinations(landmarks, 2):
        apart = float(np.linalg.norm(one.position_ras - other.position_ras))
        if apart < APART_MM and one.name != other.name:
            wrong.append(
                f"{one.name} and {other.name} are {apart:.1f} mm apart; landmarks must be "
                f"{APART_MM:g} mm apart."
            )
    three = landmarks[:COARSE_LANDMARKS]
    places = np.array([landmark.position_ras for landmark in three], dtype=float)
    spread = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)[1]
    if spread < LEAST_SPREAD_MM:
        wrong.append(
            f"The first three landmarks ({', '.join(each.name for each in three)}) are almost in a "
            "line, which leaves the head free to turn about it; let three that are spread come "
            "first."
        )
    return wrong


def spread_first(landmarks: Sequence[Landmark]) -> tuple[Landmark, ...]:
    """Return landmarks in an order whose first three enclose the largest triangle.

    They are the coarse start of a trace. The others follow as they were.
    """
    if len(landmarks) <= COARSE_LANDMARKS:
        return tuple(landmarks)

    def area(three: Sequence[Landmark]) -> float:
        a, b, c = (landmark.position_ras for landmark in three)
        return float(np.linalg.norm(np.cross(b - a, c - a)))

    first = max(combinations(landmarks, COARSE_LANDMARKS), key=area)
    names = {landmark.name for landmark in first}
    return (*first, *(each for each in landmarks if each.name not in names))


def _on_other_side(mesh: HeadMesh, landmarks: Sequence[Landmark]) -> list[str]:
    """Return a sentence for each landmark on the wrong side by its name; +R is right."""
    places = {landmark.name: landmark.position_ras for landmark in landmarks}
    middle = float((mesh.vertices[:, 0].max() + mesh.vertices[:, 0].min()) / 2.0)
    swapped, wrong = [], []
    for name, place in places.items():
        side, _, rest = name.partition(" ")
        sign = _SIDES.get(side.lower())
        if sign is None or sign * (place[0] - middle) > -ASIDE_MM:
            continue
        other = next((n for n in places if n.lower() == f"{_OTHER[side.lower()]} {rest}"), None)
        if other is None or -sign * (places[other][0] - middle) > -ASIDE_MM:
            wrong.append(
                f"{name} is on the patient's {_OTHER[side.lower()]}; R is positive on the right."
            )
        elif other not in swapped:
            swapped.append(name)
            wrong.append(f"{name} and {other} are swapped; R is positive on the patient's right.")
    return wrong
