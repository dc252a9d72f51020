"""Check a scenario: its set-up, its plan and its tasks; and read tasks that were placed by hand."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.point_files import read_markups
from rastrainer.head.mesh import HeadMesh, nearest_on_mesh, outward_normals, read_head_mesh
from rastrainer.procedure.checks import entry_fault
from rastrainer.scenario.library import checked_scenario
from rastrainer.scenario.points import LABELS, Task, touch_order
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer.work_progress import Progress, Warn
from rastrainer_simulator.authoring.planning_setup import POSES_TRIED, PlanningSetup
from rastrainer_simulator.authoring.procedure_plan import check_procedures
from rastrainer_simulator.authoring.task_proposal import PLANS, TaskPlan, target_spread
from rastrainer_simulator.core.arm import start_joints
from rastrainer_simulator.core.settings import SimulationSettings
from rastrainer_simulator.viewpoint.best_view import WIDEST_DEG

ROBOT_FOOT_MM = 110.0
"""Distance of the outermost screws from the middle of the robot's base, rounded up."""


def check_standing(scenario: Scenario, head: HeadMesh) -> list[str]:
    """Return a sentence for everything that is not on the table."""
    table, wrong = scenario.table, []
    half = np.array(table.size_mm[:2]) / 2.0
    low, high = table.center_mm - half, table.center_mm + half
    extent = f"The table reaches from {_place(low)} to {_place(high)} mm (x, y, from the robot)"
    if (low > -ROBOT_FOOT_MM).any() or (high < ROBOT_FOOT_MM).any():
        wrong.append(
            f"{extent}: the robot's foot, which needs {ROBOT_FOOT_MM:.0f} mm around its middle, "
            "would not stand on it; move the robot or the table."
        )
    foot = transforms.apply(scenario.head_to_world, head.base)[:2]
    around = scenario.stand.diameter_mm / 2.0 + scenario.perturbation.translation_mm
    if (foot - around < low).any() or (foot + around > high).any():
        wrong.append(
            f"{extent}: the head's stand at {_place(foot)} mm, which needs {around:.0f} mm around "
            "it in trials, would not be on it; move the head or the table."
        )
    lowest = lowest_in_trials_mm(scenario, head)
    if lowest < 0.0:
        wrong.append(
            f"In a trial the head may come {-lowest:.0f} mm into the table; set it up higher, or "
            "let it be moved and tilted less."
        )
    return wrong


def lowest_in_trials_mm(scenario: Scenario, head: HeadMesh) -> float:
    """Return the height of the head's lowest point above the table in the worst trial, mm."""
    limits = scenario.perturbation
    vertices = transforms.apply(scenario.head_to_world, head.vertices)
    pivot = transforms.apply(scenario.head_to_world, scenario.target.position_ras)
    aside = np.hypot(*(vertices - pivot)[:, :2].T)
    height = vertices[:, 2] - pivot[2]
    # A tilt lowers a point on its side until it is right below the pivot.
    tilt = np.minimum(np.radians(limits.tilt_deg), np.arctan2(aside, -height))
    sunk = pivot[2] + height * np.cos(tilt) - aside * np.sin(tilt)
    return float(sunk.min() - limits.translation_mm)


def _place(point: np.ndarray) -> str:
    return f"({point[0]:.0f}, {point[1]:.0f})"


def check_plan(planning: PlanningSetup) -> list[str]:
    """Return a sentence for each error in the set-up, the targets and the trajectory."""
    scenario = planning.scenario
    wrong = check_standing(scenario, planning.mesh)
    height = SimulationSettings().start_height
    if start_clearance_mm(scenario, planning.mesh) <= 0.0:
        wrong.append(
            f"A trial starts {MM_PER_M * height:.0f} mm above {scenario.target.name}: that is "
            "within the head. Let another target be the first."
        )
    try:
        start_joints(planning.setup.robot, scenario, height)
    except InputError as error:
        wrong.append(str(error))
    planning.place_head(scenario.head_to_world)
    targets = [(scenario.target.name, scenario.target.position_ras)]
    targets += [(target.name, target.position_ras) for target in scenario.targets]
    if scenario.trajectory is not None:
        targets.append((scenario.trajectory.name, scenario.trajectory.target_ras))
    for name, position in targets:
        depth = -_distance_mm(planning, position)
        if depth < 0.0:
            wrong.append(f"{name} is {-depth:.0f} mm outside of the head.")
    return wrong or _wrong_trajectory(planning)


def start_clearance_mm(scenario: Scenario, head: HeadMesh) -> float:
    """Return how far above the top of the head the tip is at least when a trial starts."""
    top = transforms.apply(scenario.head_to_world, head.vertices)[:, 2].max()
    target = transforms.apply(scenario.head_to_world, scenario.target.position_ras)[2]
    return float(target + MM_PER_M * SimulationSettings().start_height - top)


def _wrong_trajectory(planning: PlanningSetup) -> list[str]:
    trajectory = planning.scenario.trajectory
    if trajectory is None:
        return []
    if fault := entry_fault(_distance_mm(planning, trajectory.entry_ras)):
        return [f"{trajectory.name} {fault}"]
    to_world = planning.scenario.head_to_world
    entry, target = (
        transforms.apply(to_world, point) / MM_PER_M
        for point in (trajectory.entry_ras, trajectory.target_ras)
    )
    answer = planning.reach.judge(target.tolist(), entry.tolist())
    return [] if answer.reachable else [f"{trajectory.name}: {answer.reason}"]


def _distance_mm(planning: PlanningSetup, position: np.ndarray) -> float:
    """Return the signed distance of a point (3,), RAS mm, to the head: below zero inside."""
    world = transforms.apply(planning.scenario.head_to_world, position) / MM_PER_M
    return MM_PER_M * planning.collision.nearest_to_point(tuple(world.tolist())).distance_m


def check_scenario(folder: Path) -> list[str]:
    """Return a sentence for each error in the set-up, the plan and the tasks of a scenario."""
    scenario = checked_scenario(folder)
    mesh = read_head_mesh(scenario.head)
    wrong = []
    if mesh.euler_characteristic != 2:
        wrong.append("The head's surface has tunnels or loose parts; the skin must be one body.")
    planning = PlanningSetup(scenario, mesh)
    wrong += check_plan(planning) + check_procedures(planning)
    return wrong + check_tasks(planning, scenario.tasks)


ON_SKIN_MM = 1.0
APART_MM = 20.0
WORST_SPREAD = 1.0
"""Largest ratio of the expected TRE at the target to the FLE."""

NO_ROOM = (
    "there is no room for all numbers beside the arrows; spread the fiducials, or touch them in "
    "another order."
)
COMPLEXITY_TOLERANCE = 0.02
SHORTEST_PATH_TOLERANCE = 0.01
"""Tolerance, as a share of the path."""


def check_tasks(planning: PlanningSetup, tasks: Iterable[Task], first_seed: int = 0) -> list[str]:
    """Return a sentence for each error in tasks.

    Reach is checked in the nominal pose of the head and in seeded poses from `first_seed` on.
    """
    tasks = list(tasks)
    wrong = []
    for task in tasks:
        wrong += _wrong_places(planning, task) or [
            *(_untouchable(planning, task, first_seed) or _unseen(planning, task)),
            *([] if planning.views.on_skin(task)[1].has_room else [f"{task.title}: {NO_ROOM}"]),
            *_wrong_measures(task, planning.measured(task.name, task.title, task.fiducials)),
        ]
    for easier, harder in pairwise(tasks):
        if harder.complexity <= easier.complexity:
            wrong.append(
                f"{harder.title}: its complexity, {harder.complexity:.2f}, must be above "
                f"that of {easier.title}, {easier.complexity:.2f}."
            )
    return wrong


def _wrong_places(planning: PlanningSetup, task: Task) -> list[str]:
    wrong = []
    for label, point in zip(task.labels, task.fiducials, strict=True):
        away = nearest_on_mesh(planning.mesh, point).distance
        if away > ON_SKIN_MM:
            wrong.append(
                f"{task.title}: fiducial {label} is {away:.1f} mm off the skin; it must be within "
                f"{ON_SKIN_MM:g} mm."
            )
    for (one, a), (other, b) in combinations(zip(task.labels, task.fiducials, strict=True), 2):
        apart = float(np.linalg.norm(a - b))
        if apart < APART_MM - 1e-3:
            wrong.append(
                f"{task.title}: fiducials {one} and {other} are {apart:.1f} mm apart; their "
                f"numbers need {APART_MM:g} mm."
            )
    try:
        ratio = target_spread(task.fiducials, planning.scenario.target.position_ras) ** 0.5
    except np.linalg.LinAlgError:
        ratio = np.inf
    if not ratio <= WORST_SPREAD:
        wrong.append(
            f"{task.title}: its fiducials locate {planning.scenario.target.name} badly "
            f"(expected TRE {ratio:.1f} times FLE, at most {WORST_SPREAD:g}); "
            "spread them around it."
        )
    return wrong


def _untouchable(planning: PlanningSetup, task: Task, first_seed: int) -> list[str]:
    normals = outward_normals(planning.mesh, task.fiducials)
    poses = planning.poses(range(first_seed, first_seed + POSES_TRIED))
    nominal = planning.touchable(task.fiducials, normals, poses[:1])
    always = nominal & planning.touchable(task.fiducials, normals, poses[1:])
    sentences = []
    for can_be, where in ((nominal, "where the head is"), (always | ~nominal, "in every trial")):
        missed = [label for label, can in zip(task.labels, can_be, strict=True) if not can]
        if missed:
            sentences.append(
                f"{task.title}: the robot cannot touch {_listed(missed)} {where} with 5 mm "
                "clearance; move them, or the head."
            )
    return sentences


def _unseen(planning: PlanningSetup, task: Task) -> list[str]:
    """Return which fiducials no view shows together with their number and the tip."""
    views = planning.views.of(task, planning.scenario.head_to_world)
    missed = [label for label, view in views if view is None]
    return missed and [
        f"{task.title}: {_listed(missed)} cannot be seen within {WIDEST_DEG:.0f}° of the skin's "
        "normal while the robot touches; move them, or the head."
    ]


def _wrong_measures(task: Task, right: Task) -> list[str]:
    wrong = []
    if abs(right.complexity - task.complexity) > COMPLEXITY_TOLERANCE:
        wrong.append(
            f"{task.title}: its complexity is {right.complexity:.2f}, not {task.complexity:.2f}."
        )
    stated, shortest = task.shortest_path_mm, right.shortest_path_mm
    assert shortest is not None  # It was measured.
    if stated is None or abs(shortest - stated) > SHORTEST_PATH_TOLERANCE * shortest:
        instead = "none" if stated is None else f"{stated:.1f} mm"
        wrong.append(
            f"{task.title}: its shortest path is {shortest:.1f} mm; shortestPathMm says {instead}."
        )
    return wrong


def _listed(labels: list[str]) -> str:
    return f"fiducial {labels[0]}" if len(labels) == 1 else f"fiducials {', '.join(labels)}"


SNAP_MM = 5.0
"""Clicks on slices or on a rendered volume are off the skin by a voxel or two."""

MOVED_MM = 0.1
"""Fiducials nearer to the skin than this are not moved."""

_DECIMALS = 4


def read_placed_tasks(
    planning: PlanningSetup, files: tuple[Path, ...], progress: Progress, warn: Warn
) -> tuple[tuple[Task, ...], list[str]]:
    """Return the tasks of markups files, and a sentence for each of their errors.

    The files are the trial run's, Task 1's and so on. Fiducials within 5 mm of the skin are moved
    onto it; `warn` is called for each task with such.
    """
    if len(files) > len(PLANS):
        return (), [f"A scenario has at most {len(PLANS)} tasks; {len(files)} are given."]
    tasks, wrong = [], []
    for index, (path, plan) in enumerate(zip(files, PLANS, strict=False)):
        progress(f"Checking {plan.title}", index / len(files))
        try:
            fiducials = _read(planning.mesh, path, plan, warn)
        except InputError as error:
            wrong.append(f"{plan.title}: {error}")
        else:
            tasks.append(planning.measured(plan.name, plan.title, fiducials))
    return tuple(tasks), [*wrong, *check_tasks(planning, tasks)]


def _read(mesh: HeadMesh, path: Path, plan: TaskPlan, warn: Warn) -> np.ndarray:
    """Return the fiducials (15, 3) of a task, on the skin."""
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
    return points
