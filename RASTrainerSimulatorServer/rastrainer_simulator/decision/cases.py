"""Cases of a drill: finished registrations of a head by a virtual operator, sound or with a fault.

The operation's head stands where the scenario has it. The operator registers it by touched points,
or by landmarks and a trace over the skin, with localization errors of the published size. A fault
changes the touches, the head or the images, and is sized so that the error at the target spreads
around the limit: without noise, the error is proportional to the fault's size.

Images that are mirrored, scaled or of another patient show the head mapped by an affine transform,
`images`; all others show it as it is. A place of the images is truly where its anatomy is.
"""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.random import Generator, default_rng

from rastrainer import transforms
from rastrainer.decision.drill_record import CaseTruth, Fault
from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, nearest_vertices
from rastrainer.head.trial_head import UNMOVED, SkinShift
from rastrainer.protocol import RegistrationMethod
from rastrainer.registration.fits import RIGID, fit, motions
from rastrainer.registration.surface_checks import pose_rows
from rastrainer.registration.surface_error import guided_vertices
from rastrainer.registration.target_error import TargetError, true_errors
from rastrainer.scenario.points import NOSE_TIP
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.score_reference import UNDER_SKIN_MM, head_of
from rastrainer_simulator.authoring.face_removal import nose_tip
from rastrainer_simulator.virtual.method_trials import PUBLISHED_NOISE, MethodPoints, register_by

LIMIT_MM = 2.0
"""Largest acceptable error at the target: what image-guided neurosurgery asks for in all."""
MOST_ERROR = 3.0
"""The largest error that a fault is sized for, relative to the limit. The logarithm of the error is
uniform up to it, and down to as far below the limit."""
NEVER_SOUND = (Fault.MIRRORED, Fault.OTHER_PATIENT)
"""Nobody may proceed with such images, however small the error at one target happens to be."""
TOUCHED_FAULTS = Fault.BAD_FIDUCIAL, Fault.SWAPPED, Fault.MIRRORED, Fault.FAR_FIDUCIALS
"""Faults that a trace cannot have."""
TRACED_SHARE = 0.3
FLE_METHODS = (RegistrationMethod.FIDUCIALS, RegistrationMethod.LANDMARKS)
SKILL_SD = 0.45
"""Standard deviation of the logarithm of an operator's localization error."""
MANY, FEW, LEAST_LANDMARKS = (5, 13), (4, 7), 5
"""Numbers of points, from the first to below the second; two exchanged of few do harm."""
TRACE_POINTS = 120
CROWN_MM = 60.0
"""Distance from the vertex up to which the crown is traced."""
CLUSTER_MM = (30.0, 60.0)
MIDLINE_MM, ABOVE_BASE_MM = 1.0, 20.0
HALF_HEAD_MM = 100.0
TURN_DEG_PER_MM = 0.5
"""How far the head turns in its holder, on each axis, for each millimeter that it slides."""
SMALL, MOST_MM, SIZINGS = 0.5, 20.0, 3
"""The first guess of a fault's size, the largest size, and how often the size is corrected."""
ATTEMPTS = 20
VERTEX, BACK = "Vertex", "Back of the head"
SOUND_SLOPE, UNSOUND, UNSOUND_SLOPE = 1.0, 1.65, 3.0
"""Coefficients of `difficulty`, fitted to simulated observers: Testing/error_rates/tables.md."""
LEAST_DIFFICULTY = -5.0


@dataclass(frozen=True, kw_only=True, eq=False)
class DecisionCase(CaseTruth):
    """A finished registration to be judged; points in RAS of the images, mm, (n, 3) float.

    Attributes:
        registered_mm, fixed_mm: the touched points, as registered, and where they belong.
        trace_mm: as registered; empty without one.
        registration: (4, 4) float, World→RAS of the images.
        places: that can be checked, by name.
        images: (4, 4) float, from the head to its images.
    """

    labels: tuple[str, ...]
    registered_mm: np.ndarray
    fixed_mm: np.ndarray
    trace_mm: np.ndarray
    expected: TargetError
    registration: np.ndarray
    places: Mapping[str, np.ndarray]
    target_mm: np.ndarray
    head_to_world: np.ndarray
    images: np.ndarray
    skin: SkinShift
    mesh: HeadMesh

    @property
    def residuals_mm(self) -> np.ndarray:
        return np.linalg.norm(self.registered_mm - self.fixed_mm, axis=1)

    def tip_for(self, place_mm: np.ndarray) -> np.ndarray:
        """Return where the robot goes for a point (3,) of the images, (3,) World, mm.

        The head is shown with its skin as in the images. If the skin has shifted, the tip is
        returned where it is as far from the shown skin as it is from the shifted skin.
        """
        to_head = transforms.inverse(self.head_to_world) @ transforms.inverse(self.registration)
        there = self._shifted(transforms.apply(to_head, place_mm), self.skin.unmeasured)
        return transforms.apply(self.head_to_world, there)

    def in_images(self, tip_mm: np.ndarray) -> np.ndarray:
        """Return where the registration shows a tip (3,), World mm, in the images."""
        there = transforms.apply(transforms.inverse(self.head_to_world), tip_mm)
        there = self._shifted(there, self.skin.measured)
        return transforms.apply(self.registration @ self.head_to_world, there)

    def truly(self, place_mm: np.ndarray) -> np.ndarray:
        """Return where the anatomy at points (n, 3) or (3,) of the images is, World, mm."""
        return transforms.apply(self.head_to_world @ transforms.inverse(self.images), place_mm)

    def contours(self, point_mm: np.ndarray) -> tuple[list[np.ndarray], ...]:
        """Return the skin of the images, cut across x, y and z at a point (3,).

        Each cut is a list of polylines (k, 3) float, RAS of the images, mm.
        """
        import trimesh

        vertices = transforms.apply(self.images, self.mesh.vertices)
        skin = trimesh.Trimesh(vertices, self.mesh.triangles, process=False)
        cuts = (skin.section(axis, point_mm) for axis in np.eye(3))
        return tuple([] if cut is None else list(cut.discrete) for cut in cuts)

    def _shifted(
        self, there: np.ndarray, shift: Callable[[np.ndarray, HeadMesh], np.ndarray]
    ) -> np.ndarray:
        """Return a point (3,) of the head shifted with the skin, if it is there."""
        is_skin = (
            not self.skin.is_none and nearest_vertices(self.mesh, there[None])[0] < UNDER_SKIN_MM
        )
        return shift(there[None], self.mesh)[0] if is_skin else there


@dataclass(frozen=True, eq=False)
class _Operation:
    """The touches of a virtual operator and the state of head and images; RAS of the head, mm.

    `points` (n, 3) and `trace` (k, 3), with its outward `normals`, are where the images' anatomy
    really is; `astray` and `drawn` how far off each of them was measured, besides the common
    `bias`. `order` has the row of the point that was touched in place of each; `moved` (4, 4) is
    where the head was meanwhile.
    """

    method: RegistrationMethod
    labels: tuple[str, ...]
    points: np.ndarray
    trace: np.ndarray
    normals: np.ndarray
    astray: np.ndarray
    drawn: np.ndarray
    order: np.ndarray
    images: np.ndarray = field(default_factory=lambda: np.eye(4))
    moved: np.ndarray = field(default_factory=lambda: np.eye(4))
    bias: np.ndarray = field(default_factory=lambda: np.zeros(3))
    shift: SkinShift = UNMOVED

    def measured(self, mesh: HeadMesh) -> tuple[np.ndarray, np.ndarray]:
        """Return where the points (n, 3) and the trace (k, 3) were measured."""

        def of(points: np.ndarray, off: np.ndarray) -> np.ndarray:
            there = points + self.shift.moved(points, mesh)
            return transforms.apply(self.moved, there) + self.bias + off

        return of(self.points, self.astray)[self.order], of(self.trace, self.drawn)

    def error(self, mesh: HeadMesh, target: np.ndarray) -> np.ndarray:
        """Return the error (3,) at a target (3,) of the head, in the images.

        That of a trace is to first order: each of its points is fitted to the plane of the skin at
        its place, which is much quicker than a match.
        """
        points, trace = self.measured(mesh)
        in_images = transforms.apply(self.images, target)
        if not len(trace):
            matrix = fit(points, transforms.apply(self.images, self.points), RIGID)
            return true_errors(matrix, transforms.inverse(self.images), in_images)
        places = transforms.apply(self.images, self.trace)
        center = places.mean(axis=0)
        away = np.einsum("ij,ij->i", self.normals, trace - places)
        rows = pose_rows(places, self.normals, center)
        pose = np.linalg.lstsq(rows, -away, rcond=None)[0]
        return target - in_images + motions(RIGID, in_images[None] - center)[0] @ pose


class CaseMaker:
    """Makes the cases of a scenario."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario, self.mesh = scenario, head_of(scenario)
        self.target = np.asarray(scenario.target.position_ras, dtype=float)
        self.places = places_of(scenario, self.mesh)

    def case(self, seed: int, fault: Fault) -> DecisionCase:
        """Return a case; equal arguments give equal cases."""
        for attempt in range(ATTEMPTS):
            # Points on a line, for example, are drawn again.
            with contextlib.suppress(InputError):
                case = self._registered(seed, fault, self._operation(seed, fault, attempt))
                if fault not in NEVER_SOUND or not case.is_sound:
                    return case
        raise InputError(
            f"The scenario {self.scenario.name} allows no case with the fault {fault.value}: its "
            "head needs a target inside, and fiducials that are spread."
        )

    def guess_mm(self, seed: int, fault: Fault) -> float:
        """Return the true error of a case, much quicker; by a trace, only about the error."""
        return self._error_mm(self._operation(seed, fault))

    def _error_mm(self, done: _Operation) -> float:
        return float(np.linalg.norm(done.error(self.mesh, self.target)))

    def _operation(self, seed: int, fault: Fault, attempt: int = 0) -> _Operation:
        random = default_rng([seed, list(Fault).index(fault), attempt])
        farther = random.uniform(-math.log(MOST_ERROR), math.log(MOST_ERROR))
        goal_mm = LIMIT_MM * math.exp(abs(farther) if fault in NEVER_SOUND else farther)
        return self._with_fault(self._without_fault(fault, goal_mm, random), fault, goal_mm, random)

    def _registered(self, seed: int, fault: Fault, done: _Operation) -> DecisionCase:
        points, trace = done.measured(self.mesh)
        pose, fixed = self.scenario.head_to_world, transforms.apply(done.images, done.points)
        target = transforms.apply(done.images, self.target)
        touched, traced = (transforms.apply(pose, each) for each in (points, trace))
        given = MethodPoints(done.method, touched, fixed, None, traced)
        mesh = self.mesh
        if len(trace) and not np.array_equal(done.images, np.eye(4)):
            mesh = HeadMesh(transforms.apply(done.images, mesh.vertices), mesh.triangles)
        truth = pose @ transforms.inverse(done.images)
        result = register_by(given, mesh, target[None], truth, starts=1)
        assert result.true_mm is not None
        true_mm, rows, places = float(result.true_mm[0]), np.arange(len(fixed)), dict(self.places)
        if done.method is RegistrationMethod.FIDUCIALS:
            # The lowest comes first: the order of touching would tell how fiducials were chosen.
            rows = fixed[:, 2].argsort(kind="stable")
            names = (f"fiducial {label}" for label in done.labels)
            places.update(zip(names, done.points[rows], strict=True))
        return DecisionCase(
            seed=seed,
            fault=fault,
            method=done.method,
            limit_mm=LIMIT_MM,
            true_error_mm=true_mm,
            expected_error_mm=result.errors[0].expected_mm,
            residual_mm=result.residual_mm,
            difficulty=difficulty(fault, true_mm / LIMIT_MM),
            labels=done.labels,
            registered_mm=transforms.apply(result.matrix, touched)[rows],
            fixed_mm=fixed[rows],
            trace_mm=transforms.apply(result.matrix, traced),
            expected=result.errors[0],
            registration=result.matrix,
            places={name: transforms.apply(done.images, place) for name, place in places.items()},
            target_mm=target,
            head_to_world=pose,
            images=done.images,
            skin=done.shift,
            mesh=self.mesh,
        )

    def _without_fault(self, fault: Fault, goal_mm: float, random: Generator) -> _Operation:
        """Return an operation without a fault, with points that let the fault do harm."""
        skill, is_slid = math.exp(random.normal(0.0, SKILL_SD)), fault is Fault.SLID_TRACE
        method, traced = RegistrationMethod.FIDUCIALS, np.empty(0, dtype=int)
        labels = list(range(1, MANY[1] + 1))
        if is_slid or (fault not in TOUCHED_FAULTS and random.random() < TRACED_SHARE):
            method = RegistrationMethod.LANDMARKS_SURFACE
            traced = random.choice(self._crown if is_slid else self._traceable, TRACE_POINTS)
        elif fault is Fault.NONE and random.random() < TRACED_SHARE:
            method = RegistrationMethod.LANDMARKS
        if method is not RegistrationMethod.FIDUCIALS:
            names = random.permutation(list(self.places))
            names = names[: random.integers(LEAST_LANDMARKS, len(names) + 1)]
            labels, points = list(names), np.array([self.places[each] for each in names])
        elif fault in (Fault.MIRRORED, Fault.FAR_FIDUCIALS):
            points = self._unspread(fault, goal_mm, random)
        else:
            task = self.scenario.tasks[random.integers(len(self.scenario.tasks))]
            away = np.linalg.norm(task.fiducials - random.choice(task.fiducials), axis=1)
            count = random.integers(*(FEW if fault is Fault.SWAPPED else MANY))
            rows = np.sort(away.argsort(kind="stable")[:count])
            points = task.fiducials[rows]
        touched_by = method if method in FLE_METHODS else RegistrationMethod.LANDMARKS
        across = random.normal(0.0, skill * PUBLISHED_NOISE[method], (len(traced), 1))
        spread = skill * PUBLISHED_NOISE[touched_by] / math.sqrt(3.0)
        normals = self.mesh.vertex_normals[traced]
        return _Operation(
            method=method,
            labels=tuple(map(str, labels[: len(points)])),
            points=points,
            trace=self.mesh.vertices[traced],
            normals=normals,
            astray=random.normal(0.0, spread, points.shape),
            drawn=across * normals,
            order=np.arange(len(points)),
        )

    @cached_property
    def _traceable(self) -> np.ndarray:
        """Vertices (c,) int on which an operator would draw."""
        to_head = transforms.inverse(self.scenario.head_to_world)
        camera = self.scenario.cameras["close-up"]
        return guided_vertices(self.mesh, transforms.apply(to_head, camera.position_mm))

    @cached_property
    def _crown(self) -> np.ndarray:
        """Vertices (c,) int of the crown."""
        away = np.linalg.norm(self.mesh.vertices - self.places[VERTEX], axis=1)
        return np.flatnonzero(away < CROWN_MM)

    def _unspread(self, fault: Fault, goal_mm: float, random: Generator) -> np.ndarray:
        """Return points close to one another, or for mirrored images near a plane.

        Points of one plane match their mirror image, so their residual is small; a target on one
        side of the plane is taken to the other side. The plane passes it at half a distance.
        """
        vertices = self.mesh.vertices
        if fault is Fault.MIRRORED:
            normal = np.array([1.0, *random.normal(0.0, 0.15, 2)])
            normal /= np.linalg.norm(normal)
            side = random.choice([-1.0, 1.0])
            away = np.abs((vertices - self.target) @ normal - side * goal_mm / 2.0)
            away[vertices[:, 2] < vertices[:, 2].min() + ABOVE_BASE_MM] = np.inf
            most = MIDLINE_MM
        else:
            center = vertices[random.choice(self._traceable)]
            away, most = np.linalg.norm(vertices - center, axis=1), random.uniform(*CLUSTER_MM)
        nearest = away.argsort(kind="stable")[: max(int(np.sum(away <= most)), MANY[1])]
        return vertices[random.permutation(nearest)[: random.integers(*MANY)]]

    def _with_fault(
        self, done: _Operation, fault: Fault, goal_mm: float, random: Generator
    ) -> _Operation:
        """Return an operation with a fault of a size that misses the target by about so much."""
        if fault in (Fault.NONE, Fault.FAR_FIDUCIALS):
            return done
        if fault is Fault.MIRRORED:
            images = np.diag([-1.0, 1.0, 1.0, 1.0])
            images[0, 3] = 2.0 * self.mesh.middle[0]
            return replace(done, images=images)
        if fault is Fault.SWAPPED:
            pairs = itertools.combinations(range(len(done.points)), 2)
            swapped = [replace(done, order=_exchanged(done.order, *pair)) for pair in pairs]
            errors = [self._error_mm(each) for each in swapped]
            return swapped[int(np.abs(np.log(np.array(errors) / goal_mm)).argmin())]
        changes = self._sizable(done, fault, random)
        start, size = done.error(self.mesh, self.target), SMALL
        for _ in range(SIZINGS):
            change = (replace(done, **changes(size)).error(self.mesh, self.target) - start) / size
            size = min(max(_size_for(goal_mm, start, change), -MOST_MM), MOST_MM)
        return replace(done, **changes(size))

    def _sizable(
        self, done: _Operation, fault: Fault, random: Generator
    ) -> Callable[[float], dict[str, Any]]:
        """Return what changes an operation by a fault of a size, roughly mm."""
        direction = random.normal(size=3)
        direction /= np.linalg.norm(direction)
        middle, base, strain = self.mesh.middle, self.mesh.base, np.eye(3)
        if fault is Fault.BAD_FIDUCIAL:
            row = np.zeros((len(done.points), 1))
            row[random.integers(len(row))] = 1.0
            return lambda size: {"astray": done.astray + size * row * direction}
        if fault is Fault.BENT_TOOL:
            return lambda size: {"bias": size * direction}
        if fault is Fault.SHIFTED_SKIN:
            seed = int(random.integers(2**31))
            return lambda size: {"shift": SkinShift(max(size, SMALL), seed)}
        if fault is Fault.SLID_TRACE:
            hair = SkinShift(1.0, int(random.integers(2**31))).moved(done.trace, self.mesh)
            return lambda size: {"drawn": done.drawn + size * hair}
        if fault is Fault.MOVED_HEAD:
            turn = random.normal(0.0, TURN_DEG_PER_MM, 3)

            def moved(size: float) -> dict[str, Any]:
                rotation = transforms.rotations(np.radians(size * turn)[None])[0]
                return {"moved": _about(base, rotation, size * direction)}

            return moved
        if fault is Fault.OTHER_PATIENT:
            strain = random.normal(size=(3, 3))
            strain = (strain + strain.T) / 2.0
        return lambda size: {"images": _about(middle, np.eye(3) + size / HALF_HEAD_MM * strain)}


def difficulty(fault: Fault, error: float) -> float:
    """Return the difficulty of a case, logits: it falls with the margin |ln(error/limit)|.

    The error is relative to the limit. The method of registration hardly matters.
    """
    margin = math.log(max(error, 1e-3))
    start, slope = (UNSOUND, -UNSOUND_SLOPE) if margin > 0.0 else (0.0, SOUND_SLOPE)
    return max(fault.difficulty + start + slope * margin, LEAST_DIFFICULTY)


def places_of(scenario: Scenario, mesh: HeadMesh) -> dict[str, np.ndarray]:
    """Return anatomical places on a head that can be checked, (3,) float, RAS mm, by name."""
    places = {each.name: np.array(each.position_ras, float) for each in scenario.landmarks}
    places.setdefault(NOSE_TIP, np.array(nose_tip(mesh), float))
    vertices = mesh.vertices[mesh.vertices[:, 2] > mesh.vertices[:, 2].min() + ABOVE_BASE_MM]
    x, y, z = vertices.T
    for name, along in {VERTEX: z, BACK: -y, "Left ear": -x, "Right ear": x}.items():
        places.setdefault(name, vertices[along.argmax()])
    return places


def _exchanged(order: np.ndarray, one: int, other: int) -> np.ndarray:
    changed = order.copy()
    changed[[one, other]] = other, one
    return changed


def _about(center: np.ndarray, linear: np.ndarray, move: np.ndarray | float = 0.0) -> np.ndarray:
    """Return the matrix (4, 4) of a linear map about a center, and a move after it."""
    return transforms.rigid(linear, center + move - linear @ center)


def _size_for(goal_mm: float, start: np.ndarray, change: np.ndarray) -> float:
    """Return the s for which |start + s·change| is nearest to a length; the larger of two."""
    a, b = float(change @ change), float(start @ change)
    inside = b * b - a * (float(start @ start) - goal_mm**2)
    return (-b + math.sqrt(max(inside, 0.0))) / a
