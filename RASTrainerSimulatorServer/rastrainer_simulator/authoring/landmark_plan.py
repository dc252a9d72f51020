"""Landmarks from a file of their own: proposed there, and checked on the head of a scenario."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList, read_markups, write_markups
from rastrainer.head.mesh import read_head_mesh
from rastrainer.scenario.points import MAX_LANDMARKS, Landmark, check_landmarks, on_skin
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.authoring.landmark_proposal import propose_landmarks, unreachable
from rastrainer_simulator.authoring.planning_setup import PlanningSetup

LONGEST_NAME = 40


def read_placed_landmarks(path: Path) -> tuple[Landmark, ...]:
    """Return the landmarks of a markups file, in its order.

    Raises:
        InputError: the file is unusable, or a point has no name.
    """
    placed = read_markups(path)
    labels = [label.strip() for label in placed.labels or [""] * len(placed.points)]
    if len(labels) > MAX_LANDMARKS:
        raise InputError(f"{path.name} has {len(labels)} landmarks, at most {MAX_LANDMARKS} fit.")
    for number, label in enumerate(labels, 1):
        if not 1 <= len(label) <= LONGEST_NAME or not label.isprintable():
            raise InputError(
                f"Landmark {number} needs a name of 1 to {LONGEST_NAME} characters, such as Nasion."
            )
    points = np.array(placed.points, dtype=float)
    return tuple(Landmark(label, place) for label, place in zip(labels, points, strict=True))


def check_placed_landmarks(folder: Path, landmarks: Sequence[Landmark]) -> list[str]:
    """Return a sentence for each thing that is wrong with landmarks on the head of a scenario.

    Raises:
        InputError: the scenario cannot be read.
    """
    scenario = load_scenario(folder)
    planning = PlanningSetup(scenario, read_head_mesh(scenario.head_mesh))
    return check_on_planned_head(planning, landmarks)


def check_on_planned_head(planning: PlanningSetup, landmarks: Sequence[Landmark]) -> list[str]:
    """Return a sentence for each thing that is wrong with landmarks: their places, or the reach."""
    wrong = check_landmarks(planning.mesh, landmarks)
    if wrong:
        return wrong
    return [
        f"The robot does not reach {name} in every pose of a trial; leave it out, or move the head."
        for name in unreachable(planning, on_skin(planning.mesh, landmarks))
    ]


def write_proposal(folder: Path, path: Path) -> list[str]:
    """Write landmarks for the head of a scenario to a markups file; return sentences about them.

    Raises:
        InputError: the scenario cannot be read, or the file not be written.
    """
    proposed = propose_landmarks(load_scenario(folder))
    names = tuple(landmark.name for landmark in proposed.landmarks)
    places = np.array([each.position for each in proposed.landmarks], dtype=float).reshape(-1, 3)
    write_markups(path, PointList(names, places))
    said = f"{len(names)} landmarks are proposed: look at each, and move it where it is wrong."
    return [said, *proposed.left_out]
