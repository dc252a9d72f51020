"""What a trial is registered by: its touches and its trace, and where that trace lies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rastrainer import json_checks, transforms
from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList, pair
from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.json_checks import Argument, accepted, checked_keys
from rastrainer.protocol import FIDUCIAL_COUNT, MIN_TRACE_POINTS, WORLD_LIMIT_MM, RegistrationMethod
from rastrainer.registration.fits import RIGID
from rastrainer.registration.registration import register
from rastrainer.registration.trace_guidance import TraceGuide, nearest_traced_mm
from rastrainer.scenario.method_task import (
    COARSE_LANDMARKS,
    TRACED_METHODS,
    method_of,
    task_by_method,
)
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.record import TrialRecord, trace_points


@dataclass(frozen=True)
class GivenPoints:
    """What a trial is registered by.

    Attributes:
        task: name of the trial's task.
        touches: World, mm, labeled.
        method: by which they are registered.
        trace_mm: (n, 3) float, World, the points that were traced; none where the method has none.
    """

    task: str
    touches: PointList
    method: RegistrationMethod = RegistrationMethod.FIDUCIALS
    trace_mm: np.ndarray = field(default_factory=lambda: np.empty((0, 3)))

    @classmethod
    def of_record(cls, record: TrialRecord) -> GivenPoints:
        """Return the points of a finished trial."""
        touches = PointList(record.labels, record.positions_mm)
        return cls(record.task, touches, record.method, record.trace_mm)

    @classmethod
    def of_answer(
        cls, answer: Mapping[str, Any], least_traced: int = MIN_TRACE_POINTS
    ) -> GivenPoints:
        """Return the points in an answer to GetTrial about an open trial.

        Of a trace, `least_traced` points are needed: as many as register it, or fewer to show it.

        Raises:
            InputError: they are missing or invalid, or too few for their method.
        """
        method, given = method_of(answer.get("method")), answer.get("touches")
        is_all = isinstance(given, list) and (
            len(given) == FIDUCIAL_COUNT
            if method is RegistrationMethod.FIDUCIALS
            else COARSE_LANDMARKS <= len(given) <= FIDUCIAL_COUNT
        )
        if not isinstance(given, list) or not is_all:
            wanted = FIDUCIAL_COUNT if method is RegistrationMethod.FIDUCIALS else "landmarks"
            raise InputError(
                f"The simulator's answer to GetTrial must hold touches, a list of {wanted}."
            )
        points = [checked_keys(touch, _TOUCH_KEYS, "Each touch of the trial") for touch in given]
        places = np.array([point["positionMm"] for point in points])
        touches = PointList(tuple(point["label"] for point in points), places)
        trace = _trace_of(answer, method, least_traced)
        return cls(str(answer.get("task", "")), touches, method, trace)


def _trace_of(answer: Mapping[str, Any], method: RegistrationMethod, least: int) -> np.ndarray:
    if method not in TRACED_METHODS:
        return np.empty((0, 3))
    trace = accepted(trace_points, answer.get("trace"), "The trace in the answer to GetTrial")
    if len(trace) < least:
        raise InputError(
            f"The simulator's answer to GetTrial must hold a trace of {least} points or "
            f"more, not {len(trace)}."
        )
    return np.array(trace).reshape(-1, 4)[:, :3]


_TOUCH_KEYS = {
    "label": Argument(json_checks.text()),
    "positionMm": Argument(json_checks.numbers(3, WORLD_LIMIT_MM, "mm")),
}


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
