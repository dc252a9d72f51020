"""The registration of a trial's touches, while the trial is open or finished: one computation."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer import json_checks
from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList, pair
from rastrainer.json_checks import Argument, checked_keys
from rastrainer.protocol import FIDUCIAL_COUNT, WORLD_LIMIT_MM
from rastrainer.registration.fits import RIGID
from rastrainer.registration.localization_error import error_along_surface
from rastrainer.registration.registration import Registration, register_all_kinds
from rastrainer.registration.target_error import TargetError, target_error
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.score_reference import fiducial_normals


@dataclass(frozen=True)
class TouchRegistration:
    """Possible registrations of touches, and their expected errors.

    Attributes:
        fits: by kind; rigid is always included.
        target_errors: expected error at the scenario's target, by kind.
    """

    fits: Mapping[str, Registration]
    target_errors: Mapping[str, TargetError]

    @property
    def rigid(self) -> Registration:
        """The registration that is used and scored."""
        return self.fits[RIGID]

    def arguments(self, trial_id: str) -> dict[str, Any]:
        """Return the arguments of UseRegistration or SubmitRegistration, ready for JSON."""
        return {
            "trialId": trial_id,
            "matrix": [float(value) for value in self.rigid.matrix.ravel()],
            "freMm": self.rigid.fre_mm,
            "expectedTreMm": self.target_errors[RIGID].expected_mm,
        }


def register_touches(
    touches: PointList,
    scenario: Scenario,
    task_name: str,
    pause: Callable[[], None] = lambda: None,
) -> TouchRegistration:
    """Register touches (World, mm) to the fiducials of a task, paired by label.

    Args:
        touches: labeled.
        scenario: has the task.
        task_name: its name.
        pause: called between the steps, every 10 ms or so; a worker may wait in it.

    Raises:
        InputError: the scenario has no such task or labels, or the points cannot be registered.
    """
    task = scenario.task(task_name)
    labels, moving, fixed = pair(touches, PointList(task.labels, task.fiducials))
    fits = register_all_kinds(moving, fixed, labels)
    normals = normals_at(scenario, task_name, labels)
    errors = {}
    for kind, fit in fits.items():
        pause()
        localization = error_along_surface(fit, normals)
        pause()
        errors[kind] = target_error(fit, scenario.target_position, localization)
    pause()
    return TouchRegistration(fits, errors)


def touches_of(answer: Mapping[str, Any]) -> PointList:
    """Return the touches (World, mm) in an answer to GetTrial about an open trial.

    Raises:
        InputError: they are missing or invalid.
    """
    touches = answer.get("touches")
    if not isinstance(touches, list) or len(touches) != FIDUCIAL_COUNT:
        raise InputError(
            f"The simulator's answer to GetTrial must hold touches, a list of {FIDUCIAL_COUNT}."
        )
    points = [checked_keys(touch, _TOUCH_KEYS, "Each touch of the trial") for touch in touches]
    return PointList(
        tuple(point["label"] for point in points), np.array([p["positionMm"] for p in points])
    )


def normals_at(scenario: Scenario, task_name: str, labels: Sequence[str]) -> np.ndarray:
    """Return the outward normals of the skin at fiducials of a task, (n, 3) float, RAS.

    `labels` are the n fiducials'.
    """
    task = scenario.task(task_name)
    return fiducial_normals(scenario, task_name)[[task.labels.index(label) for label in labels]]


_TOUCH_KEYS = {
    "label": Argument(json_checks.text()),
    "positionMm": Argument(json_checks.numbers(3, WORLD_LIMIT_MM, "mm")),
}
