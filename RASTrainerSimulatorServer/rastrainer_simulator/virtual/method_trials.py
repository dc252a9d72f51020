"""Trials registered by every method, side by side: played trials by each method that they allow,
and virtual trials on one head, with stated noise and skin shift.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.random import Generator

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList, pair
from rastrainer.head.mesh import HeadMesh, mesh_crossings, outward_normals, read_head_mesh
from rastrainer.head.trial_head import SkinShift
from rastrainer.protocol import COARSE_LANDMARKS, TRACED_METHODS, RegistrationMethod
from rastrainer.registration.localization_error import error_along_surface, isotropic_error
from rastrainer.registration.registration import register
from rastrainer.registration.surface_checks import LEAST_POINTS
from rastrainer.registration.surface_error import (
    guided_vertices,
    knowledge_of,
    surface_target_error,
)
from rastrainer.registration.surface_match import STARTS, match_surface
from rastrainer.registration.target_error import (
    COMMON_BIAS_SD_MM,
    TargetError,
    target_error,
    true_errors,
)
from rastrainer.registration.warnings import RegistrationWarning
from rastrainer.scenario.scenario import Scenario, task_by_method
from rastrainer.transforms import frame_along
from rastrainer.trial.score_reference import region_of
from rastrainer.trial.touch_registration import LEAST_ALONG_SURFACE, GivenPoints, normals_at
from rastrainer_simulator.statistics.intervals import rms

PUBLISHED_NOISE: Mapping[RegistrationMethod, float] = {
    RegistrationMethod.BONE_SCREWS: 0.5,
    RegistrationMethod.FIDUCIALS: 1.5,
    RegistrationMethod.LANDMARKS: 4.0,
    RegistrationMethod.SURFACE: 0.5,
    RegistrationMethod.LANDMARKS_SURFACE: 0.5,
    RegistrationMethod.SCAN: 1.07,
}
"""In mm: of a touched point, the RMS length of its error (FLE); of a traced or scanned point, the
standard deviation across the skin or along the ray."""


@dataclass(frozen=True, eq=False)
class RangeCamera:
    """A simulated range camera before the head: it sees where its rays first meet the skin.

    On skin that faces it, the points are `spacing_mm` apart; the noise is along the rays.
    """

    eye: np.ndarray
    noise_mm: float
    spacing_mm: float = 8.0

    def seen(self, mesh: HeadMesh) -> np.ndarray:
        """Return the points of the skin at which the rays end, (n, 3) float, RAS mm, exact.

        The rays go through a square grid at distance 1 before the eye. Where ears, nose or brows
        hide the skin behind them, the rays end on these.
        """
        ahead = mesh.middle - self.eye
        away = float(np.linalg.norm(ahead))
        spacing, frame = self.spacing_mm / away, frame_along(ahead / away)
        skin, points = mesh.skin, []
        seen = (skin.vertices - self.eye) @ frame.T
        on_grid = seen[:, :2] / seen[:, 2:] / spacing
        low, high = np.floor(on_grid.min(axis=0)), np.ceil(on_grid.max(axis=0))
        farthest_mm = float(np.linalg.norm(seen, axis=1).max())
        for place in itertools.product(*map(np.arange, low, high + 1)):
            ray = np.array([*place, 1.0 / spacing]) @ frame
            ray /= np.linalg.norm(ray)
            if crossings := mesh_crossings(skin, self.eye, ray, farthest_mm):
                points.append(self.eye + crossings[0].distance_mm * ray)
        if len(points) < LEAST_POINTS:
            raise InputError(
                f"The range camera sees {len(points)} points of the head; a match needs "
                f"{LEAST_POINTS}: place the camera in front of the face, or its points closer "
                "together."
            )
        return np.array(points)

    def noisy(self, points: np.ndarray, random: Generator) -> np.ndarray:
        """Return points (n, 3), RAS mm, as the camera measures them."""
        rays = points - self.eye
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        return points + random.normal(0.0, self.noise_mm, (len(points), 1)) * rays


@dataclass(frozen=True, eq=False)
class MethodPoints:
    """The points that one method registers.

    Attributes:
        moving_mm: (n, 3) float, World, touched points; a surface match starts from them.
        fixed_mm: (n, 3) float, RAS, where they belong.
        normals: (n, 3) float, of the skin there, RAS; None if the error has no direction.
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
        points: number of points whose residuals count.
        residual_mm: their root mean square, mm. It does not show the error.
        matrix: (4, 4) float, World→RAS, mm.
        true_mm: (m,) float, the true target error; None if the truth is unknown.
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
        """(m,) bool: whether the interval at each target holds the true error."""
        if self.true_mm is None:
            raise InputError("The true error of this registration is not known.")
        ends = np.array([error.interval_mm for error in self.errors])
        return np.asarray((ends[:, 0] <= self.true_mm) & (self.true_mm <= ends[:, 1]))


def register_by(
    points: MethodPoints,
    mesh: HeadMesh,
    targets: np.ndarray,
    head_to_world: np.ndarray | None = None,
    starts: int = STARTS,
) -> MethodResult:
    """Register points by their method."""
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
    """Return the points of a played trial for each method that needs no more than it has.

    A trial by landmarks and surface is one by each of both, too; the surface alone starts from its
    first three landmarks.
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

    The first three are root mean squares over trials and targets, mm; the last two are None if the
    truth is unknown.
    """
    residual = rms([one.residual_mm for one in results])
    expected = rms([error.expected_mm for one in results for error in one.errors])
    true = [one.true_mm for one in results if one.true_mm is not None]
    if len(true) < len(results):
        return residual, expected, None, None
    held = np.concatenate([one.holds for one in results])
    return residual, expected, rms(np.concatenate(true)), float(held.mean())


TRACE_POINTS = 200
SCREWS = 5
SCREW_DEPTH_MM = 8.0
"""Depth of a screw's head under the skin: about the thickness of a scalp."""
LEAST_FOR_INTERVAL = 4
METHODS = tuple(PUBLISHED_NOISE)


@dataclass(eq=False)
class MethodStudy:
    """The common settings and data of virtual trials; points in RAS mm.

    Attributes:
        shift_mm: root mean square length of the skin's shift; each trial has its own.
        indentation_mm: how deep the tip presses into the skin.
        screws: (5, 3) float, under every third fiducial.
        normals: (n, 3) float, outward, of the skin at the fiducials and at the landmarks.
        camera: where the close-up view is.
    """

    scenario: Scenario
    task: str
    shift_mm: float = 0.0
    indentation_mm: float = 0.0
    starts: int = STARTS

    def __post_init__(self) -> None:
        scenario = self.scenario
        self.mesh = read_head_mesh(scenario.head)
        self.targets = region_of(scenario).targets
        self.fiducials = np.asarray(scenario.task(self.task).fiducials, dtype=float)
        chosen = self.fiducials[:: len(self.fiducials) // SCREWS][:SCREWS]
        self.screws = chosen - SCREW_DEPTH_MM * outward_normals(self.mesh, chosen)
        places = [landmark.position_ras for landmark in scenario.landmarks]
        self.landmarks = np.array(places, dtype=float).reshape(-1, 3)
        self.normals = [
            outward_normals(self.mesh, points) if len(points) else points
            for points in (self.fiducials, self.landmarks)
        ]
        to_head = transforms.inverse(scenario.head_to_world)
        eye = transforms.apply(to_head, scenario.cameras["close-up"].position_mm)
        self.camera = RangeCamera(eye, PUBLISHED_NOISE[RegistrationMethod.SCAN])

    @cached_property
    def seen(self) -> np.ndarray:
        """(n, 3) float, RAS mm: what the camera sees of the images' skin."""
        return self.camera.seen(self.mesh)

    @cached_property
    def reached(self) -> np.ndarray:
        """Vertices (c,) int on which a trainee would draw."""
        return guided_vertices(self.mesh, self.camera.eye)

    def possible(self) -> list[RegistrationMethod]:
        """Return the methods for which the scenario has the points."""
        if len(self.landmarks) >= LEAST_FOR_INTERVAL:
            return list(METHODS)
        given = {RegistrationMethod.BONE_SCREWS, RegistrationMethod.FIDUCIALS}
        if len(self.landmarks) >= COARSE_LANDMARKS:
            given |= {RegistrationMethod.SURFACE, RegistrationMethod.SCAN}
        return [method for method in METHODS if method in given]

    def trial(self, method: RegistrationMethod, seed: int) -> MethodResult:
        """Play and register one virtual trial.

        Trials of one seed have the same head, the same shift of the skin and the same tip.
        """
        if method not in self.possible():
            raise InputError(
                f"The scenario {self.scenario.name} has too few landmarks for {method.value}."
            )
        shift = SkinShift(self.shift_mm, seed, self.indentation_mm)
        pose = self.scenario.perturbed_head_to_world(seed)
        # The calibration error of the tip is the same at every touch of a trial.
        tip = np.random.default_rng([seed, 0]).normal(0.0, COMMON_BIAS_SD_MM, 3)
        random = np.random.default_rng([seed, 1 + METHODS.index(method)])
        points = self._points(method, shift, random, tip)
        moving, cloud = (transforms.apply(pose, of) for of in (points.moving_mm, points.cloud_mm))
        placed = replace(points, moving_mm=moving, cloud_mm=cloud)
        return register_by(placed, self.mesh, self.targets, pose, self.starts)

    def _points(
        self, method: RegistrationMethod, shift: SkinShift, random: Generator, tip: np.ndarray
    ) -> MethodPoints:
        """Return touched, traced or scanned points before the head is posed: all in RAS."""
        if method is RegistrationMethod.BONE_SCREWS:
            touched = self._found(self.screws, method, random) + tip
            return MethodPoints(method, touched, self.screws)
        if method is RegistrationMethod.FIDUCIALS:
            normals = self.normals[0]
            touched = shift.touched(self.fiducials, normals, self.mesh)
            touched = self._found(touched, method, random) + tip
            return MethodPoints(method, touched, self.fiducials, normals)
        count = COARSE_LANDMARKS if method is RegistrationMethod.SURFACE else len(self.landmarks)
        fixed = self.landmarks[:count]
        touched = shift.touched(fixed, self.normals[1][:count], self.mesh)
        touched = self._found(touched, RegistrationMethod.LANDMARKS, random) + tip
        if method is RegistrationMethod.LANDMARKS:
            return MethodPoints(method, touched, fixed)
        if method is RegistrationMethod.SCAN:
            # A camera presses nothing in; it measures in its own frame, whose offset is the tip's.
            seen = self.seen + shift.moved(self.seen, self.mesh)
            return MethodPoints(method, touched, fixed, None, self.camera.noisy(seen, random) + tip)
        rows = random.choice(self.reached, TRACE_POINTS)
        normals = self.mesh.vertex_normals[rows]
        drawn = shift.touched(self.mesh.vertices[rows], normals, self.mesh)
        noise = random.normal(0.0, PUBLISHED_NOISE[method], (len(rows), 1))
        return MethodPoints(method, touched, fixed, None, drawn + noise * normals + tip)

    def _found(
        self, points: np.ndarray, method: RegistrationMethod, random: Generator
    ) -> np.ndarray:
        return points + random.normal(0.0, PUBLISHED_NOISE[method] / np.sqrt(3), points.shape)
