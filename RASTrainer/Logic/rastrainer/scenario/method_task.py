"""What a trial of a task has to touch: its fiducials, or the head's landmarks.

A trial that is registered without fiducials belongs to a task all the same: to its number in the
study, and to what is compared with it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rastrainer.errors import InputError
from rastrainer.protocol import RegistrationMethod
from rastrainer.scenario.scenario import Scenario
from rastrainer.scenario.tasks import Task

TRACED_METHODS = (RegistrationMethod.SURFACE, RegistrationMethod.LANDMARKS_SURFACE)
"""In a trial by one of them the skin is traced after the landmarks were touched."""
PLAYED_METHODS = (
    RegistrationMethod.FIDUCIALS,
    RegistrationMethod.LANDMARKS,
    *TRACED_METHODS,
)
"""By which a trial can be played."""
COARSE_LANDMARKS = 3
"""That are touched before the skin is traced alone: the first ones of the scenario."""


def method_of(name: str | None) -> RegistrationMethod:
    """Return the method of a trial by its name; none stands for fiducials.

    Raises:
        InputError: no trial is played by it.
    """
    for method in PLAYED_METHODS:
        if method.value == (name or RegistrationMethod.FIDUCIALS.value):
            return method
    names = ", ".join(method.value for method in PLAYED_METHODS)
    raise InputError(f"No trial is registered by such a method; there are {names}.")


def playable_methods(scenario: Scenario) -> tuple[RegistrationMethod, ...]:
    """Return the methods by which a trial of a scenario can be played, fiducials first."""
    has_landmarks = len(scenario.landmarks) >= COARSE_LANDMARKS
    return PLAYED_METHODS if has_landmarks else PLAYED_METHODS[:1]


def task_by_method(scenario: Scenario, task_name: str, method: RegistrationMethod) -> Task:
    """Return a task with the points that a method has touched in place of its fiducials.

    Raises:
        InputError: the scenario has no such task, or too few landmarks for the method.
    """
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
