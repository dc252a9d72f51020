"""Viewpoints from which touches are seen best, and along the skin: rays, in order of merit."""

from __future__ import annotations

import logging
import math
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from rastrainer import transforms
from rastrainer.errors import RASTrainerError
from rastrainer.head.mesh import HeadMesh, outward_normals, read_head_mesh
from rastrainer.scenario.points import Task
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.clearance import LineOfSight
from rastrainer_simulator.collision.collision import head_collision
from rastrainer_simulator.collision.touch_planner import TouchPlanner
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.loop.timing import raise_thread_priority
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.scene.skin import Skin
from rastrainer_simulator.scene.skin_marks import Placement, place_marks
from rastrainer_simulator.vectors import (
    Vector,
    add,
    angle,
    cross,
    dot,
    reject,
    rotated,
    scale,
    subtract,
    unit,
    vector,
)

WIDEST_DEG = 60.0
"""Between the skin's normal and the line to the eye."""
LEAST_OFF_TOOL_DEG = 20.0
"""Between the tool and that line: seen more end-on, its own holder hides the tip."""
LIKED_DEG = 30.0
"""Between normal and line where place and depth are both judged well."""
LIKED_ELEVATION_DEG = 25.0
AWAY_M = (0.5, 0.38, 0.28)
"""From the eye to the fiducial, the best first."""
ELEVATIONS_DEG = tuple(range(-10, 81, 10))
AZIMUTHS_DEG = tuple(range(0, 360, 10))
MARGINS_M = (0.02, 0.0)
"""Around the links: in a trial the arm stands a little differently than planned."""

BESIDE_M = 0.22
BESIDE_DEG = (82.0, 75.0, 65.0)
"""Between the normal and the line along the skin, the best first."""

OFF_SKIN_M = 0.002
SHAFT_M = 0.012
"""Length of the tool behind the tip that is seen with it."""


@dataclass(frozen=True)
class ViewedTouch:
    """A touch to be viewed: World, m.

    Attributes:
        fiducial: where the tip will be.
        normal: the skin's outward unit normal there.
        number: the middle of its number on the skin.
        direction: of the tool, unit vector to its tip.
    """

    fiducial: Vector
    normal: Vector
    number: Vector
    direction: Vector

    @property
    def places(self) -> tuple[Vector, Vector, Vector]:
        """What must be seen: target, number and tip."""
        lift = scale(self.normal, OFF_SKIN_M)
        shaft = add(self.fiducial, scale(self.direction, -SHAFT_M))
        return add(self.fiducial, lift), add(self.number, lift), shaft


@dataclass(frozen=True)
class BestView:
    """A viewpoint for a touch: World, m.

    Attributes:
        eye: from where target, number and tip are seen.
        fiducial: the point in focus.
        normal: the skin's outward unit normal there.
        beside: an eye that looks along the skin; None where something is always in between.
    """

    eye: Vector
    fiducial: Vector
    normal: Vector
    beside: Vector | None


def best_view(touch: ViewedTouch, sight: LineOfSight, front: Vector) -> BestView | None:
    """Return the best view of a touch; None where none shows it within `WIDEST_DEG`.

    `sight` is that of the arm's posture in the touch, `front` the direction from the head to the
    usual camera: of equal views the one nearer to it is taken.
    """
    for margin in MARGINS_M:
        for eye in _eyes(touch, front):
            if is_seen(touch, sight, eye, margin):
                beside = _beside(touch, sight, eye)
                return BestView(eye, touch.fiducial, touch.normal, beside)
    return None


def is_seen(touch: ViewedTouch, sight: LineOfSight, eye: Vector, margin: float) -> bool:
    """Return whether an eye sees target, number and tip of a touch well enough."""
    line = subtract(eye, touch.fiducial)
    off_tool = angle(line, scale(touch.direction, -1.0))
    return (
        angle(line, touch.normal) <= math.radians(WIDEST_DEG)
        and off_tool >= math.radians(LEAST_OFF_TOOL_DEG)
        and all(sight.is_free(eye, place, margin) for place in touch.places)
        and sight.is_past_tool(eye, touch.places[1])
    )


def _eyes(touch: ViewedTouch, front: Vector) -> list[Vector]:
    """Return the positions from which a touch may be viewed, the best first."""
    ranked: list[tuple[float, Vector]] = []
    for elevation, azimuth in product(ELEVATIONS_DEG, AZIMUTHS_DEG):
        line = _direction(azimuth, elevation)
        off_normal = math.degrees(angle(line, touch.normal))
        if off_normal > WIDEST_DEG:
            continue
        cost = abs(off_normal - LIKED_DEG) + 0.5 * abs(elevation - LIKED_ELEVATION_DEG)
        cost += 0.25 * math.degrees(angle(line, front))
        for place, away in enumerate(AWAY_M):
            eye = add(touch.fiducial, scale(line, away))
            ranked.append((cost + 15.0 * place, eye))
    return [eye for _, eye in sorted(ranked)]


def _direction(azimuth_deg: float, elevation_deg: float) -> Vector:
    azimuth, elevation = math.radians(azimuth_deg), math.radians(elevation_deg)
    level = math.cos(elevation)
    return (level * math.cos(azimuth), level * math.sin(azimuth), math.sin(elevation))


def _beside(touch: ViewedTouch, sight: LineOfSight, eye: Vector) -> Vector | None:
    """Return an eye that looks along the skin, across the best view's line as far as possible."""
    target, _number, shaft = touch.places
    for place in _along_skin(touch, eye):
        off_tool = angle(subtract(place, touch.fiducial), scale(touch.direction, -1.0))
        is_side_on = off_tool >= math.radians(LEAST_OFF_TOOL_DEG)
        if is_side_on and sight.is_free(place, target) and sight.is_free(place, shaft):
            return place
    return None


def _along_skin(touch: ViewedTouch, eye: Vector) -> Iterator[Vector]:
    line = subtract(eye, touch.fiducial)
    across = reject(line, touch.normal)
    # Seen exactly along the normal, any side is across.
    start = unit(across if dot(across, across) > 1e-9 else reject((0.0, 0.0, 1.0), touch.normal))
    right = cross(touch.normal, start)
    for lean in BESIDE_DEG:
        for turn in sorted(range(-180, 180, 15), key=lambda degrees: abs(abs(degrees) - 0.1)):
            side = rotated(right, touch.normal, math.radians(turn))
            tilt = math.radians(lean)
            raised = add(scale(side, math.sin(tilt)), scale(touch.normal, math.cos(tilt)))
            yield add(touch.fiducial, scale(raised, BESIDE_M))


class TouchViews:
    """Looks for best views; it has its own collision shapes, so that a thread may use it alone."""

    def __init__(self, setup: SimulationSetup, head: HeadMesh | None = None) -> None:
        """Use what a simulation is made from; the head is read if it is not given.

        Raises:
            InputError: the head cannot be read.
        """
        self._scenario: Scenario = setup.scenario
        self._head = head or read_head_mesh(setup.scenario.head_mesh)
        self._collision = head_collision(setup.shape, self._head, setup.scenario.furniture)
        self._kinematics = make_kinematics(setup.robot)
        self._planner = TouchPlanner(setup.robot, self._collision)
        self._known: dict[bytes, tuple[np.ndarray, Placement]] = {}

    def of(self, task: Task, head_to_world: np.ndarray) -> Iterator[tuple[str, BestView | None]]:
        """Yield each fiducial's label and best view, None where there is none.

        HeadToWorld is (4, 4) float, mm. A fiducial that the robot cannot touch has no view.
        """
        pose = np.array(head_to_world, dtype=float)
        pose[:3, 3] /= MM_PER_M
        self._collision.set_head_pose(pose)
        in_head, placement = self._on_skin(task)
        numbers = np.array(placement.places)
        normals = in_head @ pose[:3, :3].T
        places, beside = (
            transforms.apply(pose, points / MM_PER_M) for points in (task.fiducials, numbers)
        )
        camera = self._scenario.cameras["close-up"]
        front = unit(subtract(_vector(camera.position), _vector(camera.focal_point)))
        for label, place, normal, number in zip(task.labels, places, normals, beside, strict=True):
            planned = self._planner.touch(place, normal)
            if planned is None:
                yield label, None
                continue
            sight = self._collision.line_of_sight(self._kinematics.links(planned.q))
            touch = ViewedTouch(*map(_vector, (place, normal, number, planned.direction)))
            yield label, best_view(touch, sight, front)

    def placement(self, task: Task) -> Placement:
        """Return where the marks of a task are on the skin."""
        return self._on_skin(task)[1]

    def _on_skin(self, task: Task) -> tuple[np.ndarray, Placement]:
        """Return the skin's normals at a task's fiducials, (n, 3), and where its marks are."""
        key = task.fiducials.tobytes()
        if key not in self._known:
            normals = outward_normals(self._head, task.fiducials)
            placement = place_marks(Skin(self._head), task.fiducials, task.labels)
            self._known[key] = normals, placement
        return self._known[key]


def _vector(array: np.ndarray) -> Vector:
    return vector(array.tolist())


_log = logging.getLogger(__name__)


class BestViews:
    """Finds the views of one trial's touches after another, in their order.

    Each is there as soon as it is found. What belongs to the head and the task is kept for the
    next trial, for it makes ticks late.
    """

    def __init__(self) -> None:
        self._found: dict[str, BestView] = {}
        self._lock = threading.Lock()
        self._views: tuple[SimulationSetup, TouchViews] | None = None

    def look(self, setup: SimulationSetup, task: str, head_to_world: np.ndarray) -> None:
        """Start looking for those of a trial; HeadToWorld is the trial's, (4, 4) float, mm."""
        found: dict[str, BestView] = {}
        self._found = found
        threading.Thread(
            target=self._look,
            args=(setup, task, head_to_world, found),
            name="best views",
            daemon=True,
        ).start()

    def of(self, label: str | None) -> BestView | None:
        """Return the best view of a fiducial; None if it is not found yet, or there is none."""
        return None if label is None else self._found.get(label)

    def forget(self) -> None:
        """Stop looking."""
        self._found = {}

    def _look(
        self,
        setup: SimulationSetup,
        task: str,
        head_to_world: np.ndarray,
        found: dict[str, BestView],
    ) -> None:
        # Set aside while it holds the interpreter, it would make the control loop wait.
        raise_thread_priority()
        try:
            with self._lock:
                for label, view in self._views_of(setup).of(
                    setup.scenario.task(task), head_to_world
                ):
                    if self._found is not found:
                        return
                    if view is not None:
                        found[label] = view
        except (RASTrainerError, OSError):
            _log.exception("The best views of %s cannot be found", task)

    def _views_of(self, setup: SimulationSetup) -> TouchViews:
        if self._views is None or self._views[0] is not setup:
            self._views = setup, TouchViews(setup)
        return self._views[1]
