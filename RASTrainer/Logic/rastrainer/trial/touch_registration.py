"""The registration of a trial, while it is open or finished: one computation for all methods.

A trace is matched to the surface of the scenario's head, from where the landmarks put it. What
counts of such a registration is its matrix: its residuals are those of the landmarks, which it does
not make least, and its FRE is the root mean square of the trace's inliers to the surface.

Where the skin lay otherwise than in the images, the points are also put back and registered again:
that shows what the shift did.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList, pair
from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.head.skin_shift import SkinShift
from rastrainer.protocol import RegistrationMethod
from rastrainer.registration.fits import RIGID
from rastrainer.registration.localization_error import (
    LocalizationError,
    error_along_surface,
    isotropic_error,
)
from rastrainer.registration.registration import Registration, register_all_kinds
from rastrainer.registration.surface_error import knowledge_of, surface_target_error
from rastrainer.registration.surface_match import SurfaceMatch, match_surface
from rastrainer.registration.target_error import TargetError, target_error, true_errors
from rastrainer.scenario.method_task import TRACED_METHODS, task_by_method
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.given_points import GivenPoints
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.score_reference import point_normals
from rastrainer.trial.wording import Sentence, say

LEAST_ALONG_SURFACE = 6
"""Touches; of fewer, the residuals do not separate the error along the skin from that across it."""


@dataclass(frozen=True)
class TouchRegistration:
    """Possible registrations of a trial, and their expected errors.

    Attributes:
        fits: by kind; rigid is always included.
        target_errors: expected error at the scenario's target, by kind.
        match: of the trace, where the method has one.
    """

    fits: Mapping[str, Registration]
    target_errors: Mapping[str, TargetError]
    match: SurfaceMatch | None = None

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


def register_trial(
    given: GivenPoints, scenario: Scenario, pause: Callable[[], None] = lambda: None
) -> TouchRegistration:
    """Register what was touched and traced in a trial, by the trial's method.

    Args:
        given: the touches are paired by label with the fiducials of the task, or the landmarks.
        scenario: of the trial.
        pause: called between the steps, every 10 ms or so; a worker may wait in it.

    Raises:
        InputError: the scenario has no such task or labels, or the points cannot be registered.
    """
    task = task_by_method(scenario, given.task, given.method)
    labels, moving, fixed = pair(given.touches, PointList(task.labels, task.fiducials))
    fits = register_all_kinds(moving, fixed, labels)
    if given.method in TRACED_METHODS:
        return _by_trace(given, scenario, fits[RIGID], pause)
    normals = normals_at(scenario, given.task, labels, given.method)
    errors = {}
    for kind, fit in fits.items():
        pause()
        localization = _localization_error(fit, normals)
        pause()
        errors[kind] = target_error(fit, scenario.target_position, localization)
    pause()
    return TouchRegistration(fits, errors)


def _by_trace(
    given: GivenPoints, scenario: Scenario, coarse: Registration, pause: Callable[[], None]
) -> TouchRegistration:
    """Return the rigid registration alone: a scaled or sheared head would fit any trace."""
    match = match_surface(given.trace_mm, head_of(scenario), coarse.matrix)
    pause()
    error = surface_target_error(knowledge_of(match), scenario.target_position)
    return TouchRegistration({RIGID: _matched(coarse, match)}, {RIGID: error}, match)


def _localization_error(fit: Registration, normals: np.ndarray) -> LocalizationError:
    """Return how the points are localized; few cannot separate errors along and across the skin."""
    if len(fit.labels) < LEAST_ALONG_SURFACE:
        return isotropic_error(fit)
    return error_along_surface(fit, normals)


def _matched(coarse: Registration, match: SurfaceMatch) -> Registration:
    """Return the registration of landmarks with the matrix that fits the trace to the surface."""
    vectors = transforms.apply(match.matrix, coarse.moving_mm) - coarse.fixed_mm
    return replace(
        coarse,
        matrix=match.matrix,
        fre_mm=match.rms_mm,
        residual_vectors_mm=vectors,
        residuals_mm=np.linalg.norm(vectors, axis=1),
        warnings=(*coarse.warnings, *match.warnings),
    )


def head_of(scenario: Scenario) -> HeadMesh:
    """Return the scenario's head, which is read once while its file is unchanged."""
    path = scenario.head_mesh
    return _read_head(path, path.stat().st_mtime_ns if path.is_file() else 0)


@lru_cache(maxsize=1)
def _read_head(path: Path, _changed: int) -> HeadMesh:
    return read_head_mesh(path)


def normals_at(
    scenario: Scenario, task_name: str, labels: Sequence[str], method: RegistrationMethod
) -> np.ndarray:
    """Return the outward normals of the skin at points of a task by a method, (n, 3) float, RAS.

    `labels` are those of the n points.
    """
    task = task_by_method(scenario, task_name, method)
    rows = [task.labels.index(label) for label in labels]
    return point_normals(scenario, task)[rows]


def unshifted_tre_mm(
    record: TrialRecord, scenario: Scenario, head_to_world: np.ndarray, skin: SkinShift
) -> float | None:
    """Return the true TRE that a trial would have had with the skin as in the images, mm.

    Its touches and its trace are put back to where they would have been measured, and registered
    again.

    Args:
        record: The trial.
        scenario: In which it was played.
        head_to_world: (4, 4) float, mm, the true pose.
        skin: How the skin lay, with its seed.

    Returns:
        None where the skin lay as in the images, or where the points cannot be registered so.
    """
    if skin.is_none:
        return None
    to_head, mesh = transforms.inverse(head_to_world), head_of(scenario)
    given = GivenPoints.of_record(record)

    def put_back(points: np.ndarray) -> np.ndarray:
        in_head = skin.unmeasured(transforms.apply(to_head, points), mesh)
        return transforms.apply(head_to_world, in_head)

    touches = PointList(given.touches.labels, put_back(given.touches.points))
    unshifted = replace(given, touches=touches, trace_mm=put_back(given.trace_mm))
    try:
        matrix = register_trial(unshifted, scenario).rigid.matrix
    except InputError:
        return None
    return float(np.linalg.norm(true_errors(matrix, head_to_world, scenario.target_position)))


def skin_sentence(
    skin: SkinShift, true_tre_mm: float, unshifted_mm: float | None
) -> Sentence | None:
    """Return what the trainee reads after a trial; None where the skin lay as in the images."""
    if skin.is_none:
        return None
    amounts = {"shift": skin.rms_mm, "indentation": skin.indentation_mm, "tre": true_tre_mm}
    if unshifted_mm is None:
        return say("skin", **amounts)
    return say("skin and error", **amounts, without=unshifted_mm)
