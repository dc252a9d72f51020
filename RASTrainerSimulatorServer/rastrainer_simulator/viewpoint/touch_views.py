"""The best views of a task's touches in one pose of the head."""

from __future__ import annotations

import logging
import threading
from collections.abc import Iterator

import numpy as np

from rastrainer import transforms
from rastrainer.errors import RASTrainerError
from rastrainer.head.mesh import HeadMesh, outward_normals, read_head_mesh
from rastrainer.scenario.points import Task
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.collision import head_collision
from rastrainer_simulator.collision.touch_planner import TouchPlanner
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.loop.precise_clock import raise_thread_priority
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.scene.skin import Skin
from rastrainer_simulator.scene.skin_marks import place_marks
from rastrainer_simulator.vectors import Vector, subtract, unit, vector
from rastrainer_simulator.viewpoint.best_view import BestView, ViewedTouch, best_view


class TouchViews:
    """Looks for best views; it has its own collision shapes, so that a thread may use it alone."""

    def __init__(self, setup: SimulationSetup, head: HeadMesh | None = None) -> None:
        """Take what a simulation is made from; the head is read where it is not given.

        Raises:
            InputError: the head cannot be read.
        """
        self._scenario: Scenario = setup.scenario
        self._head = head or read_head_mesh(setup.scenario.head_mesh)
        self._collision = head_collision(setup.shape, self._head, setup.scenario.furniture)
        self._kinematics = make_kinematics(setup.robot)
        self._planner = TouchPlanner(setup.robot, self._collision)
        self._known: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def of(self, task: Task, head_to_world: np.ndarray) -> Iterator[tuple[str, BestView | None]]:
        """Yield each fiducial's label and best view, None where there is none.

        HeadToWorld is (4, 4) float, mm. A fiducial that the robot cannot touch has no view.
        """
        pose = np.array(head_to_world, dtype=float)
        pose[:3, 3] /= MM_PER_M
        self._collision.set_head_pose(pose)
        in_head, numbers = self._on_skin(task)
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

    def _on_skin(self, task: Task) -> tuple[np.ndarray, np.ndarray]:
        """Return the skin's normals at a task's fiducials, and where their numbers are, (n, 3)."""
        key = task.fiducials.tobytes()
        if key not in self._known:
            normals = outward_normals(self._head, task.fiducials)
            marks = place_marks(Skin(self._head), task.fiducials, task.labels)
            self._known[key] = normals, np.array(marks.places)
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
        """Begin to look for those of a trial; HeadToWorld is the trial's, (4, 4) float, mm."""
        found: dict[str, BestView] = {}
        self._found = found
        threading.Thread(
            target=self._look,
            args=(setup, task, head_to_world, found),
            name="best views",
            daemon=True,
        ).start()

    def of(self, label: str | None) -> BestView | None:
        """Return the best view of a fiducial; None where it is not found yet, or there is none."""
        return None if label is None else self._found.get(label)

    def forget(self) -> None:
        """Look for no more."""
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
