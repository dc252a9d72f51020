"""One trial registered by every method that its points allow, side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList, pair
from rastrainer.head.mesh import HeadMesh
from rastrainer.protocol import RegistrationMethod
from rastrainer.registration.localization_error import error_along_surface, isotropic_error
from rastrainer.registration.registration import register
from rastrainer.registration.surface_error import knowledge_of, surface_target_error
from rastrainer.registration.surface_match import STARTS, match_surface
from rastrainer.registration.target_error import TargetError, target_error, true_errors
from rastrainer.registration.warnings import RegistrationWarning
from rastrainer.scenario.method_task import COARSE_LANDMARKS, TRACED_METHODS, task_by_method
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.given_points import GivenPoints
from rastrainer.trial.score_reference import region_of
from rastrainer.trial.touch_registration import LEAST_ALONG_SURFACE, normals_at


@dataclass(frozen=True, eq=False)
class MethodPoints:
    """What one method registers.

    Attributes:
        method: the method.
        moving_mm: (n, 3) float, World, touched points; those of a surface match give its start.
        fixed_mm: (n, 3) float, RAS, where they belong.
        normals: (n, 3) float, of the skin there, RAS; None where the error has no direction.
        cloud_mm: (k, 3) float, World, traced or scanned points; empty of touches alone.
    """

    method: RegistrationMethod
    moving_mm: np.ndarray
    fixed_mm: np.ndarray
    normals: np.ndarray | None = None
    cloud_mm: np.ndarray = field(default_factory=lambda: np.empty((0, 3)))


@dataclass(frozen=True, eq=False)
class MethodResult:
    """How a method registered a trial.

    Attributes:
        method: the method.
        points: number of points whose residuals count.
        residual_mm: their root mean square, mm. It does not show the error.
        matrix: (4, 4) float, World→RAS, mm.
        errors: expected at each target, with their intervals.
        true_mm: (m,) float, the true target error; None where the truth is unknown.
        warnings: what looks wrong.
    """

    method: RegistrationMethod
    points: int
    residual_mm: float
    matrix: np.ndarray
    errors: tuple[TargetError, ...]
    true_mm: np.ndarray | None
    warnings: tuple[RegistrationWarning, ...]

    @property
    def holds(self) -> np.ndarray:
        """(m,) bool: whether the interval at each target holds the true error.

        Raises:
            InputError: the truth is unknown.
        """
        if self.true_mm is None:
            raise InputError("The true error of this registration is not known.")
        ends = np.array([error.interval_mm for error in self.errors])
        return np.asarray((ends[:, 0] <= self.true_mm) & (self.true_mm <= ends[:, 1]))


def targets_of(scenario: Scenario) -> np.ndarray:
    """Return the targets at which methods are compared, (m, 3) float, RAS mm."""
    return region_of(scenario).targets


def register_by(
    points: MethodPoints,
    mesh: HeadMesh,
    targets: np.ndarray,
    head_to_world: np.ndarray | None = None,
    starts: int = STARTS,
) -> MethodResult:
    """Register points by their method.

    Args:
        points: of one method.
        mesh: the head, RAS mm.
        targets: (m, 3) float, RAS mm.
        head_to_world: (4, 4) float, mm, the truth, where it is known.
        starts: of a surface match.

    Raises:
        InputError: the points cannot be registered.
    """
    fit = register(points.moving_mm, points.fixed_mm)
    if len(points.cloud_mm):
        match = match_surface(points.cloud_mm, mesh, fit.matrix, starts=starts)
        known = knowledge_of(match)
        errors = tuple(surface_target_error(known, target) for target in targets)
        matrix, residual, count = match.matrix, match.rms_mm, int(match.is_inlier.sum())
        warnings = match.warnings
    else:
        normals = points.normals
        if normals is None or len(points.moving_mm) < LEAST_ALONG_SURFACE:
            error = isotropic_error(fit)
        else:
            error = error_along_surface(fit, normals)
        errors = tuple(target_error(fit, target, error) for target in targets)
        matrix, residual, count = fit.matrix, fit.fre_mm, len(fit.labels)
        warnings = fit.warnings
    true = None
    if head_to_world is not None:
        true = np.linalg.norm(true_errors(matrix, head_to_world, targets), axis=1)
    return MethodResult(points.method, count, residual, matrix, errors, true, warnings)


def points_of_trial(given: GivenPoints, scenario: Scenario) -> tuple[MethodPoints, ...]:
    """Return what a played trial gives to each method: its own, and those that need no more.

    A trial by landmarks and surface is one by each of both, too; the surface alone starts from its
    first three landmarks.

    Raises:
        InputError: the points are not those of the scenario.
    """
    task = task_by_method(scenario, given.task, given.method)
    labels, moving, fixed = pair(given.touches, PointList(task.labels, task.fiducials))
    normals = None
    if given.method is RegistrationMethod.FIDUCIALS:
        normals = normals_at(scenario, given.task, labels, given.method)
    if given.method not in TRACED_METHODS:
        return (MethodPoints(given.method, moving, fixed, normals),)
    found = []
    if len(labels) > COARSE_LANDMARKS:
        found.append(MethodPoints(RegistrationMethod.LANDMARKS, moving, fixed))
    first = [labels.index(name) for name in task.labels[:COARSE_LANDMARKS] if name in labels]
    alone = first if len(first) == COARSE_LANDMARKS else list(range(len(labels)))
    surface = RegistrationMethod.SURFACE
    found.append(MethodPoints(surface, moving[alone], fixed[alone], None, given.trace_mm))
    if given.method is RegistrationMethod.LANDMARKS_SURFACE:
        found.append(MethodPoints(given.method, moving, fixed, None, given.trace_mm))
    return tuple(found)


def mean_of(results: Sequence[MethodResult]) -> tuple[float, float, float | None, float | None]:
    """Return residual, expected and true error, and the share of intervals that hold the truth.

    The first three are root mean squares over trials and targets, mm; the last two are None where
    the truth is unknown.
    """
    residual = _rms([one.residual_mm for one in results])
    expected = _rms([error.expected_mm for one in results for error in one.errors])
    true = [one.true_mm for one in results if one.true_mm is not None]
    if len(true) < len(results):
        return residual, expected, None, None
    held = np.concatenate([one.holds for one in results])
    return residual, expected, _rms(np.concatenate(true)), float(held.mean())


def _rms(values: Sequence[float] | np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
