"""Virtual trials by every method of registration on one head, with stated noise and skin shift."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.random import Generator

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.head.skin_shift import SkinShift
from rastrainer.head.surface_queries import outward_normals
from rastrainer.protocol import RegistrationMethod
from rastrainer.registration.surface_match import STARTS
from rastrainer.registration.target_error import COMMON_BIAS_SD_MM
from rastrainer.registration.trace_guidance import guided_vertices
from rastrainer.scenario.method_task import COARSE_LANDMARKS
from rastrainer.scenario.scenario import Scenario
from rastrainer_simulator.virtual.method_comparison import (
    MethodPoints,
    MethodResult,
    register_by,
    targets_of,
)
from rastrainer_simulator.virtual.method_noise import PUBLISHED_NOISE, MethodNoise, RangeCamera

TRACE_POINTS = 200
SCREWS = 5
SCREW_DEPTH_MM = 8.0
"""Of a screw's head under the skin: about the thickness of a scalp."""
LEAST_FOR_INTERVAL = 4
METHODS = tuple(PUBLISHED_NOISE)


@dataclass(frozen=True, eq=False)
class MethodStudy:
    """What the virtual trials have in common.

    Attributes:
        scenario: with the head and its landmarks.
        task: whose fiducials are touched.
        shift_mm: root mean square length of the skin's shift; each trial has its own.
        indentation_mm: how deep the tip presses into the skin.
        noise: of each method.
        starts: of a surface match.
    """

    scenario: Scenario
    task: str
    shift_mm: float = 0.0
    indentation_mm: float = 0.0
    noise: Mapping[RegistrationMethod, MethodNoise] = field(default_factory=lambda: PUBLISHED_NOISE)
    starts: int = STARTS

    @cached_property
    def mesh(self) -> HeadMesh:
        """The head of the images."""
        return read_head_mesh(self.scenario.head_mesh)

    @cached_property
    def targets(self) -> np.ndarray:
        """(m, 3) float, RAS mm."""
        return targets_of(self.scenario)

    @cached_property
    def fiducials(self) -> np.ndarray:
        """(15, 3) float, RAS mm."""
        return np.asarray(self.scenario.task(self.task).fiducials, dtype=float)

    @cached_property
    def screws(self) -> np.ndarray:
        """(5, 3) float, RAS mm: under every third fiducial."""
        chosen = self.fiducials[:: len(self.fiducials) // SCREWS][:SCREWS]
        return chosen - SCREW_DEPTH_MM * outward_normals(self.mesh, chosen)

    @cached_property
    def landmarks(self) -> np.ndarray:
        """(l, 3) float, RAS mm; none where the scenario has too few."""
        places = [landmark.position for landmark in self.scenario.landmarks]
        return np.array(places, dtype=float).reshape(-1, 3)

    @cached_property
    def normals(self) -> tuple[np.ndarray, np.ndarray]:
        """Outward unit normals of the skin at fiducials and landmarks."""
        at_fiducials, at_landmarks = (
            outward_normals(self.mesh, points) if len(points) else points
            for points in (self.fiducials, self.landmarks)
        )
        return at_fiducials, at_landmarks

    @cached_property
    def camera(self) -> RangeCamera:
        """The range camera, where the close-up view is."""
        to_head = transforms.inverse(self.scenario.head_to_world)
        eye = transforms.apply(to_head, self.scenario.cameras["close-up"].position)
        return RangeCamera(eye, self.noise[RegistrationMethod.SCAN].point_mm)

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

        Raises:
            InputError: the scenario lacks the method's points, or they cannot be registered.
        """
        if method not in self.possible():
            raise InputError(
                f"The scenario {self.scenario.name} has too few landmarks for {method.value}."
            )
        shift = SkinShift(self.shift_mm, seed, self.indentation_mm)
        pose = self.scenario.perturbed_head_to_world(seed)
        # The calibration of the tip is off alike at every touch of a trial.
        tip = np.random.default_rng([seed, 0]).normal(0.0, COMMON_BIAS_SD_MM, 3)
        random = np.random.default_rng([seed, 1 + METHODS.index(method)])
        points = self._points(method, shift, random, tip)
        moving, cloud = (transforms.apply(pose, of) for of in (points.moving_mm, points.cloud_mm))
        placed = replace(points, moving_mm=moving, cloud_mm=cloud)
        return register_by(placed, self.mesh, self.targets, pose, self.starts)

    def _points(
        self, method: RegistrationMethod, shift: SkinShift, random: Generator, tip: np.ndarray
    ) -> MethodPoints:
        """Return what is touched, traced or scanned, before the head is posed: all in RAS."""
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
        noise = random.normal(0.0, self.noise[method].point_mm, (len(rows), 1))
        return MethodPoints(method, touched, fixed, None, drawn + noise * normals + tip)

    def _found(
        self, points: np.ndarray, method: RegistrationMethod, random: Generator
    ) -> np.ndarray:
        return points + random.normal(0.0, self.noise[method].point_mm / np.sqrt(3), points.shape)
