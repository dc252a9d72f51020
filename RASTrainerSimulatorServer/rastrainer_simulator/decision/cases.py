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

import numpy as np
from numpy.random import Generator, default_rng

from rastrainer import transforms
from rastrainer.decision.drill_record import Fault
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
TRACED_FAULTS = (
    Fault.NONE,
    Fault.MOVED_HEAD,
    Fault.SCALED,
    Fault.BENT_TOOL,
    Fault.SHIFTED_SKIN,
    Fault.OTHER_PATIENT,
)
"""Faults that a trace may have, besides sliding."""
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
FAULT_DIFFICULTY = {
    Fault.NONE: -1.5,
    Fault.BAD_FIDUCIAL: -1.5,
    Fault.SWAPPED: -1.6,
    Fault.SLID_TRACE: -1.6,
    Fault.MOVED_HEAD: -1.5,
    Fault.MIRRORED: -5.0,
    Fault.SCALED: -1.8,
    Fault.FAR_FIDUCIALS: -1.5,
    Fault.BENT_TOOL: -1.3,
    Fault.SHIFTED_SKIN: -1.0,
    Fault.OTHER_PATIENT: -1.7,
}
SOUND_SLOPE, UNSOUND, UNSOUND_SLOPE = 1.0, 1.65, 3.0
"""Coefficients of `difficulty`, fitted to simulated observers: Testing/error_rates/tables.md."""
LEAST_DIFFICULTY = -5.0


@dataclass(frozen=True, eq=False)
class DecisionCase:
    """A finished registration to be judged; points in RAS of the images, mm, (n, 3) float.

    Attributes:
        labels: of the touched points.
        registered_mm: the touched points, as registered.
        fixed_mm: where these points are in the images.
        trace_mm: the trace, as registered; empty without one.
        residuals_mm: (n,) float, of the touched points.
        residual_mm: root mean square, as shown: of the touched points (FRE), or of the trace.
        registration: (4, 4) float, World→RAS of the images.
        places: that can be checked, by name.
        limit_mm: largest acceptable error at the target.
        difficulty: of a Rasch model, logits.
        head_to_world: (4, 4) float: where the head is.
        images: (4, 4) float, from the head to its images.
        skin: how the skin has shifted since the images were taken.
        mesh: the head.
    """

    seed: int
    fault: Fault
    method: RegistrationMethod
    labels: tuple[str, ...]
    registered_mm: np.ndarray
    fixed_mm: np.ndarray
    trace_mm: np.ndarray
    residuals_mm: np.ndarray
    residual_mm: float
    expected: TargetError
    registration: np.ndarray
    places: Mapping[str, np.ndarray]
    target_mm: np.ndarray
    limit_mm: float
    true_error_mm: float
    difficulty: float
    head_to_world: np.ndarray
    images: np.ndarray
    skin: SkinShift
    mesh: HeadMesh

    @property
    def is_sound(self) -> bool:
        return self.true_error_mm <= self.limit_mm

    def tip_for(self, place_mm: np.ndarray) -> np.ndarray:
        """Return where the robot goes for a point (3,) of the images, (3,) World, mm.

        The head is shown with its skin as in the images. If the skin has shifted, the tip is
        returned where it is as far from the shown skin as it is from the shifted skin.
        """
        to_head = transforms.inverse(self.head_to_world) @ transforms.inverse(self.registration)
        there = transforms.apply(to_head, place_mm)
        if self._is_skin(there):
            there = self.skin.unmeasured(there[None], self.mesh)[0]
        return transforms.apply(self.head_to_world, there)

    def in_images(self, tip_mm: np.ndarray) -> np.ndarray:
        """Return where the registration shows a tip (3,), World mm, in the images."""
        there = transforms.apply(transforms.inverse(self.head_to_world), tip_mm)
        if self._is_skin(there):
            there = self.skin.measured(there[None], self.mesh)[0]
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

    def _is_skin(self, there: np.ndarray) -> bool:
        if self.skin.is_none:
            return False
        return bool(nearest_vertices(self.mesh, there[None])[0] < UNDER_SKIN_MM)


@dataclass(frozen=True, eq=False)
class _Operation:
    """The touches of a virtual operator and the state of head and images; RAS of the head, mm.

    Attributes:
        points, trace: (n, 3) and (k, 3) float, where the images' anatomy really is.
        normals: (k, 3) float, outward, of the skin at the trace.
        astray, drawn: (n, 3) and (k, 3) float, how far off each point of both was measured.
        order: (n,) int, row of the point that was touched in place of each.
        images: as in `DecisionCase`.
        moved: (4, 4) float, where the head was when it was registered.
        bias: (3,) float, of every touch.
        shift: of the skin.
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
        registered = transforms.apply(result.matrix, touched)
        places = dict(self.places)
        if not len(trace) and done.method is RegistrationMethod.FIDUCIALS:
            names = (f"fiducial {label}" for label in done.labels)
            places.update(zip(names, done.points, strict=True))
        return DecisionCase(
            seed=seed,
            fault=fault,
            method=done.method,
            labels=done.labels,
            registered_mm=registered,
            fixed_mm=fixed,
            trace_mm=transforms.apply(result.matrix, traced),
            residuals_mm=np.linalg.norm(registered - fixed, axis=1),
            residual_mm=result.residual_mm,
            expected=result.errors[0],
            registration=result.matrix,
            places={name: transforms.apply(done.images, place) for name, place in places.items()},
            target_mm=target,
            limit_mm=LIMIT_MM,
            true_error_mm=float(result.true_mm[0]),
            difficulty=difficulty(fault, float(result.true_mm[0]) / LIMIT_MM),
            head_to_world=pose,
            images=done.images,
            skin=done.shift,
            mesh=self.mesh,
        )

    def _without_fault(self, fault: Fault, goal_mm: float, random: Generator) -> _Operation:
        """Return an operation without a fault, with points that let the fault do harm."""
        skill = math.exp(random.normal(0.0, SKILL_SD))
        method, rows = RegistrationMethod.FIDUCIALS, np.empty(0, dtype=int)
        if fault is Fault.SLID_TRACE or (fault in TRACED_FAULTS and random.random() < TRACED_SHARE):
            method = RegistrationMethod.LANDMARKS_SURFACE
            vertices = self._crown if fault is Fault.SLID_TRACE else self._traceable
            rows = random.choice(vertices, TRACE_POINTS)
        elif fault is Fault.NONE and random.random() < TRACED_SHARE:
            method = RegistrationMethod.LANDMARKS
        if method is not RegistrationMethod.FIDUCIALS:
            names = random.permutation(list(self.places))
            names = names[: random.integers(LEAST_LANDMARKS, len(names) + 1)]
            labels, points = tuple(map(str, names)), np.array([self.places[each] for each in names])
        elif fault in (Fault.MIRRORED, Fault.FAR_FIDUCIALS):
            near = self._near_midline if fault is Fault.MIRRORED else self._cluster
            points = near(goal_mm, random)
            labels = tuple(str(number) for number in range(1, len(points) + 1))
        else:
            labels, points = self._patch(FEW if fault is Fault.SWAPPED else MANY, random)
        touched_by = method if method in FLE_METHODS else RegistrationMethod.LANDMARKS
        across = random.normal(0.0, skill * PUBLISHED_NOISE[method], (len(rows), 1))
        spread = skill * PUBLISHED_NOISE[touched_by] / math.sqrt(3.0)
        normals = self.mesh.vertex_normals[rows]
        return _Operation(
            method=method,
            labels=labels,
            points=points,
            trace=self.mesh.vertices[rows],
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

    def _patch(
        self, counts: tuple[int, int], random: Generator
    ) -> tuple[tuple[str, ...], np.ndarray]:
        """Return labels and places of neighboring fiducials of a task."""
        task = self.scenario.tasks[random.integers(len(self.scenario.tasks))]
        away = np.linalg.norm(task.fiducials - random.choice(task.fiducials), axis=1)
        rows = np.sort(away.argsort(kind="stable")[: random.integers(*counts)])
        return tuple(task.labels[row] for row in rows), task.fiducials[rows]

    def _near_midline(self, goal_mm: float, random: Generator) -> np.ndarray:
        """Return points near a plane that passes the target at half a distance.

        Points of one plane match their mirror image, so their residual is small; a target on one
        side of the plane is taken to the other side.
        """
        normal = np.array([1.0, *random.normal(0.0, 0.15, 2)])
        normal /= np.linalg.norm(normal)
        vertices, side = self.mesh.vertices, random.choice([-1.0, 1.0])
        off = np.abs((vertices - self.target) @ normal - side * goal_mm / 2.0)
        off[vertices[:, 2] < vertices[:, 2].min() + ABOVE_BASE_MM] = np.inf
        return self._some_within(off, MIDLINE_MM, random)

    def _cluster(self, _goal_mm: float, random: Generator) -> np.ndarray:
        """Return points close to one another."""
        center = self.mesh.vertices[random.choice(self._traceable)]
        away = np.linalg.norm(self.mesh.vertices - center, axis=1)
        return self._some_within(away, random.uniform(*CLUSTER_MM), random)

    def _some_within(self, away: np.ndarray, most: float, random: Generator) -> np.ndarray:
        """Return vertices that are no farther away, (v,) mm, than so much; at least the nearest."""
        nearest = away.argsort(kind="stable")[: max(int(np.sum(away <= most)), MANY[1])]
        return self.mesh.vertices[random.permutation(nearest)[: random.integers(*MANY)]]

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
            orders = _exchanges(len(done.points))
            swapped = [replace(done, order=order) for order in orders]
            errors = [self._error_mm(each) for each in swapped]
            return swapped[int(np.abs(np.log(np.array(errors) / goal_mm)).argmin())]
        build = self._sizable(done, fault, random)
        start, size = done.error(self.mesh, self.target), SMALL
        for _ in range(SIZINGS):
            change = (build(size).error(self.mesh, self.target) - start) / size
            size = min(max(_size_for(goal_mm, start, change), -MOST_MM), MOST_MM)
        return build(size)

    def _sizable(
        self, done: _Operation, fault: Fault, random: Generator
    ) -> Callable[[float], _Operation]:
        """Return what makes an operation with a fault of a size, roughly mm."""
        direction = random.normal(size=3)
        direction /= np.linalg.norm(direction)
        if fault is Fault.BAD_FIDUCIAL:
            row = np.zeros((len(done.points), 1))
            row[random.integers(len(row))] = 1.0
            return lambda size: replace(done, astray=done.astray + size * row * direction)
        if fault is Fault.BENT_TOOL:
            return lambda size: replace(done, bias=size * direction)
        if fault is Fault.SHIFTED_SKIN:
            seed = int(random.integers(2**31))
            return lambda size: replace(done, shift=SkinShift(max(size, SMALL), seed))
        if fault is Fault.SLID_TRACE:
            hair = SkinShift(1.0, int(random.integers(2**31))).moved(done.trace, self.mesh)
            return lambda size: replace(done, drawn=done.drawn + size * hair)
        if fault is Fault.MOVED_HEAD:
            base, turn = self.mesh.base, random.normal(0.0, TURN_DEG_PER_MM, 3)

            def moved(size: float) -> _Operation:
                rotation = transforms.rotations(np.radians(size * turn)[None])[0]
                move = base + size * direction - rotation @ base
                return replace(done, moved=transforms.rigid(rotation, move))

            return moved
        strain = np.eye(3)
        if fault is Fault.OTHER_PATIENT:
            strain = random.normal(size=(3, 3))
            strain = (strain + strain.T) / 2.0
        middle = self.mesh.middle

        def stretched(size: float) -> _Operation:
            linear = np.eye(3) + size / HALF_HEAD_MM * strain
            return replace(done, images=transforms.rigid(linear, middle - linear @ middle))

        return stretched


def difficulty(fault: Fault, error: float) -> float:
    """Return the difficulty of a case, logits: it falls with the margin |ln(error/limit)|.

    The error is relative to the limit. The method of registration hardly matters.
    """
    margin = math.log(max(error, 1e-3))
    if margin <= 0.0:
        found = FAULT_DIFFICULTY[fault] + SOUND_SLOPE * margin
    else:
        found = FAULT_DIFFICULTY[fault] + UNSOUND - UNSOUND_SLOPE * margin
    return max(found, LEAST_DIFFICULTY)


def places_of(scenario: Scenario, mesh: HeadMesh) -> dict[str, np.ndarray]:
    """Return anatomical places on a head that can be checked, (3,) float, RAS mm, by name."""
    places = {each.name: np.asarray(each.position_ras, float) for each in scenario.landmarks}
    places.setdefault(NOSE_TIP, nose_tip(mesh))
    vertices = mesh.vertices[mesh.vertices[:, 2] > mesh.vertices[:, 2].min() + ABOVE_BASE_MM]
    for name, (axis, sign) in {
        VERTEX: (2, 1.0),
        BACK: (1, -1.0),
        "Left ear": (0, -1.0),
        "Right ear": (0, 1.0),
    }.items():
        places.setdefault(name, vertices[(sign * vertices[:, axis]).argmax()])
    return {name: np.array(place, dtype=float) for name, place in places.items()}


def _exchanges(count: int) -> list[np.ndarray]:
    """Return the orders (n,) int of points of which two are exchanged."""
    orders = []
    for pair in itertools.combinations(range(count), 2):
        order = np.arange(count)
        order[list(pair)] = pair[::-1]
        orders.append(order)
    return orders


def _size_for(goal_mm: float, start: np.ndarray, change: np.ndarray) -> float:
    """Return the s for which |start + s·change| is nearest to a length; the larger of two."""
    a, b = float(change @ change), float(start @ change)
    inside = b * b - a * (float(start @ start) - goal_mm**2)
    return (-b + math.sqrt(max(inside, 0.0))) / a
