"""Viewpoints from which touches are seen best, and along the skin: rays, in order of merit."""

from __future__ import annotations

import functools
import itertools
import logging
import math
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from rastrainer import transforms
from rastrainer.errors import RASTrainerError
from rastrainer.head.mesh import HeadMesh, outward_normals
from rastrainer.scenario.points import Task
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.score_reference import head_of
from rastrainer_simulator.collision.clearance import LineOfSight
from rastrainer_simulator.collision.collision import head_collision
from rastrainer_simulator.collision.touch_planner import TouchPlanner
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.loop.timing import raise_thread_priority
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.vectors import (
    Vector,
    add,
    angle,
    cross,
    distance,
    dot,
    reject,
    rotated,
    scale,
    subtract,
    unit,
    vector,
)

if TYPE_CHECKING:
    from rastrainer_simulator.scene.skin_marks import Placement

_log = logging.getLogger(__name__)

WIDEST_DEG = 60.0
"""Angle between the skin's normal and the line to the eye."""
LEAST_OFF_TOOL_DEG = 20.0
"""Angle between the tool and that line: seen more end-on, its own holder hides the tip."""
LIKED_DEG = 30.0
"""Angle between normal and line at which place and depth are both judged well."""
LIKED_ELEVATION_DEG = 25.0
AWAY_M = (0.5, 0.38, 0.28)
"""Distances from the eye to the fiducial, the best first."""
ELEVATIONS_DEG = tuple(range(-10, 81, 10))
AZIMUTHS_DEG = tuple(range(0, 360, 10))
MARGIN_M = 0.02
"""Around the links, where there is room for it: the arm moves on."""

BESIDE_M = 0.22
BESIDE_DEG = (82.0, 75.0, 65.0)
"""Angles between the normal and the line along the skin, the best first."""
LEVEL_DEG = 10.0
STEEPEST_DEG = 45.0
"""How far that line may rise or fall: the picture stays upright, and never looks into the neck."""

OFF_SKIN_M = 0.002
SHAFT_M = 0.012
"""Length of the tool behind the tip that is seen with it."""
AT_POINT_M = 0.02
"""A tool whose tip is so near the point comes from there, and does not cover it."""
IN_PICTURE_M = 0.15
"""A tip farther from the point is mostly out of the picture, and need not be seen."""


@dataclass(frozen=True)
class HeldTool:
    """The tool in one posture of the arm, and the lines of sight past that; World, m."""

    tip: Vector
    direction: Vector
    sight: LineOfSight

    @property
    def shaft(self) -> Vector:
        """What must be seen of the tool."""
        return add(self.tip, scale(self.direction, -SHAFT_M))


@dataclass(frozen=True)
class PointViews:
    """The views of a fiducial in any posture of the arm: World, m.

    Head and table leave its `marks`, a little above fiducial and number, visible from the `eyes`
    (k, 3), the best first. `normal` is the skin's, a unit vector. `planned` is the posture in which
    it is to be touched, None if the robot cannot.
    """

    fiducial: Vector
    normal: Vector
    marks: tuple[Vector, Vector]
    eyes: np.ndarray
    planned: HeldTool | None


@dataclass(frozen=True)
class BestView:
    """A viewpoint for a touch: an eye that sees fiducial, number and tip as well as possible.

    `is_whole` is whether it sees all of them. The eye `beside` looks along the skin; None if
    something is always in between. World, m.
    """

    eye: Vector
    fiducial: Vector
    beside: Vector | None
    is_whole: bool


def best_view(views: PointViews, postures: Sequence[HeldTool]) -> BestView | None:
    """Return the best view of a fiducial; None if the head always hides it.

    The first of the postures counts most. The first of equal views is taken that also keeps a
    margin to the links.
    """
    eyes = views.eyes
    if not len(eyes):
        return None
    hidden, tight = zip(*(_hidden(views, held) for held in postures), strict=True)
    order = np.lexsort((np.arange(len(eyes)), sum(tight), *reversed(hidden)))
    now, seeing = postures[0], order
    if _is_near(views, now):
        seeing = order[now.sight.is_past_head(eyes[order], now.shaft)]
    eye = vector(eyes[(seeing if len(seeing) else order)[0]])
    is_whole = len(seeing) > 0 and not hidden[0][seeing[0]]
    return BestView(eye, views.fiducial, _beside(views, postures, eye), is_whole)


def _is_near(point: PointViews, held: HeldTool) -> bool:
    return distance(held.tip, point.fiducial) <= IN_PICTURE_M


def _must_be_seen(point: PointViews, held: HeldTool) -> tuple[Vector, ...]:
    return (*point.marks, held.shaft) if _is_near(point, held) else point.marks


def _hidden(point: PointViews, held: HeldTool) -> tuple[np.ndarray, np.ndarray]:
    """Return how much of fiducial, number and tip the arm hides from each eye, (k,) int.

    The second count is of links that are thicker by `MARGIN_M`.
    """
    sight, eyes = held.sight, point.eyes
    hidden = (sight.off_tool(eyes, point.marks[1]) <= 0.0).astype(int)
    if distance(held.tip, point.fiducial) > AT_POINT_M:
        hidden += sight.off_tool(eyes, point.marks[0]) <= 0.0
    if _is_near(point, held):
        lines = eyes - held.tip
        along_tool = -(lines @ held.direction) / np.linalg.norm(lines, axis=1)
        hidden += along_tool > math.cos(math.radians(LEAST_OFF_TOOL_DEG))
    tight = np.zeros(len(eyes), dtype=int)
    for place in _must_be_seen(point, held):
        off_links = sight.off_links(eyes, place)
        hidden += off_links <= 0.0
        tight += off_links <= MARGIN_M
    return hidden, tight


def _eyes(fiducial: Vector, normal: Vector, front: Vector) -> list[Vector]:
    """Return the positions from which a touch may be viewed, the best first.

    `front` is the direction from the head to the usual camera: views nearer to it are better.
    """
    ranked: list[tuple[float, Vector]] = []
    for elevation, azimuth in product(ELEVATIONS_DEG, AZIMUTHS_DEG):
        turn, level = math.radians(azimuth), math.cos(math.radians(elevation))
        line = level * math.cos(turn), level * math.sin(turn), math.sin(math.radians(elevation))
        off_normal = math.degrees(angle(line, normal))
        if off_normal > WIDEST_DEG:
            continue
        cost = abs(off_normal - LIKED_DEG) + 0.5 * abs(elevation - LIKED_ELEVATION_DEG)
        cost += 0.25 * math.degrees(angle(line, front))
        for place, away in enumerate(AWAY_M):
            ranked.append((cost + 15.0 * place, add(fiducial, scale(line, away))))
    return [eye for _, eye in sorted(ranked)]


def _beside(point: PointViews, postures: Sequence[HeldTool], eye: Vector) -> Vector | None:
    """Return an eye that looks along the skin, level and across the best view's line if possible.

    None if the head is always in between.
    """
    sight, target = postures[0].sight, point.marks[0]
    beside = _along_skin(point, eye)
    is_past = sight.is_past_head(np.reshape(beside, (-1, 3)), target)
    places = list(itertools.compress(beside, is_past))

    def is_seen(held: HeldTool, place: Vector) -> bool:
        off_tool = angle(subtract(place, held.tip), scale(held.direction, -1.0))
        is_side_on = off_tool >= math.radians(LEAST_OFF_TOOL_DEG) or not _is_near(point, held)
        _target, _number, *shaft = _must_be_seen(point, held)
        return is_side_on and all(held.sight.is_free(place, each) for each in (target, *shaft))

    free = (each for each in places if all(is_seen(held, each) for held in postures))
    return next(free, places[0] if places else None)


def _along_skin(point: PointViews, eye: Vector) -> list[Vector]:
    """Return the positions from which one may look along the skin, the best first."""
    line = subtract(eye, point.fiducial)
    across = reject(line, point.normal)
    # Seen exactly along the normal, any side is across.
    start = unit(across if dot(across, across) > 1e-9 else reject((0.0, 0.0, 1.0), point.normal))
    right = cross(point.normal, start)
    ranked: list[tuple[float, Vector]] = []
    for lean, turn in product(BESIDE_DEG, range(-180, 180, 15)):
        side = rotated(right, point.normal, math.radians(turn))
        tilt = math.radians(lean)
        raised = add(scale(side, math.sin(tilt)), scale(point.normal, math.cos(tilt)))
        rise = abs(math.degrees(math.asin(raised[2])))
        if rise <= STEEPEST_DEG:
            off_across = min(abs(turn), 180 - abs(turn))
            cost = 2.0 * max(0.0, rise - LEVEL_DEG) + BESIDE_DEG[0] - lean + 0.2 * off_across
            ranked.append((cost, add(point.fiducial, scale(raised, BESIDE_M))))
    return [place for _, place in sorted(ranked)]


def load_marks() -> None:
    """Import what places marks on the skin; in a trial the import would make ticks late."""
    import rastrainer_simulator.scene.skin_marks  # noqa: F401


class TouchViews:
    """Looks for the views of a task's fiducials; with its own collision shapes, for one thread."""

    def __init__(self, setup: SimulationSetup, head: HeadMesh | None = None) -> None:
        self._scenario: Scenario = setup.scenario
        self._head = head or head_of(setup.scenario)
        self._collision = head_collision(setup.shape, self._head, setup.scenario)
        self._kinematics = make_kinematics(setup.robot)
        self._robot = setup.robot
        self._planner = TouchPlanner(setup.robot, self._collision)
        self._points: dict[str, tuple[Vector, Vector, tuple[Vector, Vector]]] = {}
        self._views: dict[str, PointViews] = {}

    def begin(self, task: Task, head_to_world: np.ndarray) -> None:
        """Put the head where a trial of a task has it; HeadToWorld is (4, 4) float, mm."""
        pose = transforms.in_meters(head_to_world)
        self._collision.set_head_pose(pose)
        in_head, placement = self.on_skin(task)
        normals = in_head @ pose[:3, :3].T
        places, numbers = (
            transforms.apply(pose, points / MM_PER_M)
            for points in (task.fiducials, np.array(placement.places))
        )
        lifted = OFF_SKIN_M * normals
        self._points = {
            label: (vector(place), vector(normal), (vector(mark), vector(number)))
            for label, place, normal, mark, number in zip(
                task.labels, places, normals, places + lifted, numbers + lifted, strict=True
            )
        }
        self._views = {}

    def views(self, label: str) -> PointViews:
        """Return the views of a fiducial of the present task in any posture of the arm."""
        if label not in self._views:
            fiducial, normal, marks = self._points[label]
            planned = self._planner.touch(np.array(fiducial), np.array(normal))
            held = None if planned is None else self._held(planned.q)
            sight = self._held(self._robot.home).sight
            camera = self._scenario.cameras["close-up"]
            front = unit(subtract(vector(camera.position_mm), vector(camera.focal_point_mm)))
            eyes = np.reshape(_eyes(fiducial, normal, front), (-1, 3))
            for mark in marks:
                eyes = eyes[sight.is_past_head(eyes, mark)]
            self._views[label] = PointViews(fiducial, normal, marks, eyes, held)
        return self._views[label]

    def best(self, label: str, q: Sequence[float]) -> BestView | None:
        """Return the best view of a fiducial while the arm has joint angles `q`, rad."""
        views = self.views(label)
        planned = () if views.planned is None else (views.planned,)
        return best_view(views, (self._held(q), *planned))

    def of(self, task: Task, head_to_world: np.ndarray) -> Iterator[tuple[str, BestView | None]]:
        """Yield each fiducial's label and best view during its touch, as planned.

        None if the robot cannot touch it, or no view shows it with its number and the tip.
        HeadToWorld is (4, 4) float, mm.
        """
        self.begin(task, head_to_world)
        for label in task.labels:
            views = self.views(label)
            view = None if views.planned is None else best_view(views, (views.planned,))
            yield label, view if view is not None and view.is_whole else None

    def _held(self, q: Sequence[float]) -> HeldTool:
        links = self._kinematics.links(q)
        tip = links[self._robot.tip.name]
        sight = self._collision.line_of_sight(links)
        return HeldTool(vector(tip[:3, 3]), vector(tip[:3, 2]), sight)

    def on_skin(self, task: Task) -> tuple[np.ndarray, Placement]:
        """Return the skin's normals at a task's fiducials, (n, 3), and where its marks are."""
        return _on_skin(self._head, task.fiducials.tobytes(), task.labels)


@functools.lru_cache(maxsize=12)
def _on_skin(
    head: HeadMesh, fiducials: bytes, labels: tuple[str, ...]
) -> tuple[np.ndarray, Placement]:
    # Here, since an idle simulator does without VTK.
    from rastrainer_simulator.scene.skin_marks import Skin, place_marks

    points = np.frombuffer(fiducials).reshape(-1, 3)
    return outward_normals(head, points), place_marks(Skin(head), points, labels)


@dataclass(frozen=True)
class _ViewedTrial:
    setup: SimulationSetup
    task: Task
    head_to_world: np.ndarray


class BestViews:
    """Finds the views of one trial's touches, in a thread.

    Results for the head and the task are kept for the next trial, as computing them makes ticks
    late.
    """

    def __init__(self) -> None:
        # Set aside while it holds the interpreter, it would make the control loop wait.
        self._worker = ThreadPoolExecutor(1, "best views", raise_thread_priority)
        self._trial: _ViewedTrial | None = None
        self._views: tuple[_ViewedTrial, TouchViews] | None = None

    def look(self, setup: SimulationSetup, task: str, head_to_world: np.ndarray) -> None:
        """Prepare the searches of a trial; HeadToWorld is the trial's, (4, 4) float, mm."""
        trial = self._trial = _ViewedTrial(setup, setup.scenario.task(task), head_to_world)
        for label in trial.task.labels:
            self._worker.submit(self._find, trial, label)

    def search(self, label: str, q: Sequence[float]) -> Future[BestView | None]:
        """Look for the best view of a fiducial while the arm has joint angles `q`, rad."""
        return self._worker.submit(self._find, self._trial, label, q)

    def forget(self) -> None:
        self._trial = None

    def _find(
        self, trial: _ViewedTrial | None, label: str, q: Sequence[float] | None = None
    ) -> BestView | None:
        """Return the best view; without a posture only what does not depend on it is computed."""
        if trial is None or trial is not self._trial:
            return None
        try:
            known = self._views
            is_same_robot = known is not None and known[0].setup is trial.setup
            views = known[1] if known is not None and is_same_robot else TouchViews(trial.setup)
            if known is None or known[0] is not trial:
                views.begin(trial.task, trial.head_to_world)
                self._views = trial, views
            views.views(label)
        except (RASTrainerError, OSError):
            _log.exception("The best views of %s cannot be found", trial.task.name)
            return None
        return None if q is None else views.best(label, q)
