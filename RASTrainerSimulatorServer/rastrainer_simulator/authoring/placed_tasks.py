"""Read manually placed fiducials as the tasks of a scenario."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.markups import read_markups
from rastrainer.head.mesh import HeadMesh
from rastrainer.head.surface_queries import nearest_on_mesh
from rastrainer.progress import Progress, Warn
from rastrainer.scenario.tasks import LABELS, Task, touch_order
from rastrainer_simulator.authoring.planning_setup import PlanningSetup
from rastrainer_simulator.authoring.task_check import check_tasks, measured
from rastrainer_simulator.authoring.task_proposal import PLANS, TaskPlan

SNAP_MM = 5.0
"""Clicks on slices or on a rendered volume are off the skin by a voxel or two."""

MOVED_MM = 0.1
"""Fiducials nearer to the skin than this are not moved."""

_DECIMALS = 4


def read_placed_tasks(
    planning: PlanningSetup, files: tuple[Path, ...], progress: Progress, warn: Warn
) -> tuple[tuple[Task, ...], list[str]]:
    """Return the tasks of markups files, and what is wrong with them, one sentence each.

    Fiducials within 5 mm of the skin are moved onto it.

    Args:
        planning: with the head.
        files: the trial run's, Task 1's and so on.
        progress: called with each step's name and the share done; may raise to cancel.
        warn: called for each task whose fiducials are moved.
    """
    if len(files) > len(PLANS):
        return (), [f"A scenario has at most {len(PLANS)} tasks; {len(files)} are given."]
    tasks, wrong = [], []
    for index, (path, plan) in enumerate(zip(files, PLANS, strict=False)):
        progress(f"Checking {plan.title}", index / len(files))
        try:
            task = _read(planning.mesh, path, plan, warn)
        except InputError as error:
            wrong.append(f"{plan.title}: {error}")
        else:
            tasks.append(measured(planning, task))
    return tuple(tasks), [*wrong, *check_tasks(planning, tasks)]


def _read(mesh: HeadMesh, path: Path, plan: TaskPlan, warn: Warn) -> Task:
    """Return a task on the skin.

    Raises:
        InputError: the file cannot be used, or a fiducial is far from the skin or on another one.
    """
    placed = read_markups(path)
    labels = placed.labels or [""] * len(placed.points)
    points = np.array(placed.points, dtype=float)[touch_order(labels)]
    nearest = [nearest_on_mesh(mesh, point) for point in points]
    away = np.array([place.distance for place in nearest])
    far = np.flatnonzero(away > SNAP_MM)
    if len(far):
        listed = ", ".join(f"{LABELS[row]} ({away[row]:.0f} mm)" for row in far)
        raise InputError(f"off the skin by more than {SNAP_MM:g} mm: {listed}; place them on it.")
    moved = np.flatnonzero(away > MOVED_MM)
    for row in moved:
        points[row] = nearest[row].position.round(_DECIMALS)
    if len(moved):
        warn(
            f"{plan.title}: {len(moved)} fiducials were moved onto the skin, by at most "
            f"{away.max():.1f} mm."
        )
    if len(np.unique(points, axis=0)) != len(LABELS):
        raise InputError("two fiducials are at the same place.")
    return Task(plan.name, plan.title, LABELS, points, 0.0)
