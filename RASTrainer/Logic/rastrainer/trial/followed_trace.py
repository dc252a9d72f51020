"""The trace of an open trial on the head of its scenario, as far as its landmarks tell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer import transforms
from rastrainer.files.point_list import PointList, pair
from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.registration.fits import RIGID
from rastrainer.registration.registration import register
from rastrainer.registration.trace_guidance import TraceGuide, nearest_traced_mm
from rastrainer.scenario.method_task import task_by_method
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.given_points import GivenPoints


@dataclass(frozen=True, eq=False)
class FollowedTrace:
    """A trace where the landmarks put it.

    Attributes:
        places: (n, 3) float, RAS mm.
        away_mm: (v,) float, from each vertex of the head to the nearest of them; infinite before
            the first.
        next_place: (3,) float, RAS mm, where the next points would help most; None without one.
    """

    places: np.ndarray
    away_mm: np.ndarray
    next_place: np.ndarray | None


class TraceFollower:
    """Follows the trace of one trial; only what is new is computed.

    The true pose of the head stays unknown: the landmarks that were touched stand for it.
    """

    def __init__(self, scenario: Scenario) -> None:
        """Read the head of a scenario.

        Raises:
            InputError: the head cannot be read.
        """
        self._scenario = scenario
        self._mesh = read_head_mesh(scenario.head_mesh)
        self._guide = trace_guide(scenario, self._mesh)
        self._traced = np.zeros((0, 3))
        self._matrix = np.eye(4)
        self._away = np.full(len(self._mesh.vertices), np.inf)

    def follow(self, given: GivenPoints, is_drawing: bool) -> FollowedTrace:
        """Return the trace so far; `is_drawing` says whether a stroke is being drawn.

        Raises:
            InputError: the touches are not those of the landmarks, or cannot be registered.
        """
        task = task_by_method(self._scenario, given.task, given.method)
        labels, moving, fixed = pair(given.touches, PointList(task.labels, task.fiducials))
        matrix, known = register(moving, fixed, RIGID, labels).matrix, len(self._traced)
        is_longer = np.array_equal(given.trace_mm[:known], self._traced)
        if not is_longer or not np.array_equal(matrix, self._matrix):
            known, self._away = 0, np.full(len(self._mesh.vertices), np.inf)
        places = transforms.apply(matrix, given.trace_mm)
        self._away = nearest_traced_mm(self._mesh.vertices, places[known:], self._away)
        self._traced, self._matrix = given.trace_mm, matrix
        found = self._guide.next_place(places, is_drawing)
        return FollowedTrace(places, self._away, None if found is None else found.position)


def trace_guide(scenario: Scenario, mesh: HeadMesh) -> TraceGuide:
    """Return the guidance on a scenario's head for who looks at it by the close-up camera."""
    to_head = transforms.inverse(scenario.head_to_world)
    eye = transforms.apply(to_head, scenario.cameras["close-up"].position)
    return TraceGuide(mesh, scenario.target_position, eye)
