"""What a trial is registered by: its touches and its trace, of an open trial or a finished one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rastrainer import json_checks
from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList
from rastrainer.json_checks import Argument, accepted, checked_keys
from rastrainer.protocol import FIDUCIAL_COUNT, MIN_TRACE_POINTS, WORLD_LIMIT_MM
from rastrainer.registration.methods import RegistrationMethod
from rastrainer.scenario.method_task import COARSE_LANDMARKS, TRACED_METHODS, method_of
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
        method, told = method_of(answer.get("method")), answer.get("touches")
        is_all = isinstance(told, list) and (
            len(told) == FIDUCIAL_COUNT
            if method is RegistrationMethod.FIDUCIALS
            else COARSE_LANDMARKS <= len(told) <= FIDUCIAL_COUNT
        )
        if not isinstance(told, list) or not is_all:
            wanted = FIDUCIAL_COUNT if method is RegistrationMethod.FIDUCIALS else "landmarks"
            raise InputError(
                f"The simulator's answer to GetTrial must hold touches, a list of {wanted}."
            )
        points = [checked_keys(touch, _TOUCH_KEYS, "Each touch of the trial") for touch in told]
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
