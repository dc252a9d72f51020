"""Check a scenario: its set-up, its plan and its tasks."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.procedure.checks import ENTRY_OFF_SKIN_MM
from rastrainer.scenario.library import checked_scenario
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.authoring.planning_setup import PlanningSetup
from rastrainer_simulator.authoring.procedure_check import check_procedures
from rastrainer_simulator.authoring.task_check import check_tasks
from rastrainer_simulator.collision.touch_planner import PlanReach
from rastrainer_simulator.core.arm import start_joints
from rastrainer_simulator.core.settings import SimulationSettings

ROBOT_FOOT_MM = 110.0
"""From the middle of the robot's base to its outermost screws, rounded up."""


def check_standing(scenario: Scenario, head: HeadMesh) -> list[str]:
    """Return a sentence for each thing that is not on the table."""
    table, wrong = scenario.furniture, []
    half = table.table_size[:2] / 2.0
    low, high = table.table_center - half, table.table_center + half
    extent = f"The table reaches from {_place(low)} to {_place(high)} mm (x, y, from the robot)"
    if (low > -ROBOT_FOOT_MM).any() or (high < ROBOT_FOOT_MM).any():
        wrong.append(
            f"{extent}: the robot's foot, which needs {ROBOT_FOOT_MM:.0f} mm around its middle, "
            "would not stand on it; move the robot or the table."
        )
    foot = transforms.apply(scenario.head_to_world, head.base)[:2]
    around = table.stand_diameter / 2.0 + scenario.perturbation.translation_mm
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
    pivot = transforms.apply(scenario.head_to_world, scenario.target_position)
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
            f"A trial starts {MM_PER_M * height:.0f} mm above {scenario.target_name}: that is "
            "within the head. Let another target be the first."
        )
    try:
        start_joints(planning.setup.robot, scenario, height)
    except InputError as error:
        wrong.append(str(error))
    _pose_head(planning)
    targets = [(scenario.target_name, scenario.target_position)]
    targets += [(target.name, target.position) for target in scenario.targets]
    if scenario.trajectory is not None:
        targets.append((scenario.trajectory.name, scenario.trajectory.target))
    for name, position in targets:
        depth = -_distance_mm(planning, position)
        if depth < 0.0:
            wrong.append(f"{name} is {-depth:.0f} mm outside of the head.")
    return wrong or _wrong_trajectory(planning)


def start_clearance_mm(scenario: Scenario, head: HeadMesh) -> float:
    """Return how far above the head's highest place the tip is where a trial starts, at least."""
    top = transforms.apply(scenario.head_to_world, head.vertices)[:, 2].max()
    target = transforms.apply(scenario.head_to_world, scenario.target_position)[2]
    return float(target + MM_PER_M * SimulationSettings().start_height - top)


def _wrong_trajectory(planning: PlanningSetup) -> list[str]:
    trajectory = planning.scenario.trajectory
    if trajectory is None:
        return []
    off_skin = _distance_mm(planning, trajectory.entry)
    if abs(off_skin) > ENTRY_OFF_SKIN_MM:
        side = "above the skin" if off_skin > 0.0 else "below the skin, within the head"
        return [
            f"{trajectory.name} enters {abs(off_skin):.0f} mm {side}; its entry must be within "
            f"{ENTRY_OFF_SKIN_MM:g} mm of the skin."
        ]
    to_world = planning.scenario.head_to_world
    entry, target = (
        transforms.apply(to_world, point) / MM_PER_M
        for point in (trajectory.entry, trajectory.target)
    )
    reach = PlanReach(planning.setup.robot, planning.kinematics, planning.collision)
    answer = reach.judge(target.tolist(), entry.tolist())
    return [] if answer.reachable else [f"{trajectory.name}: {answer.reason}"]


def _pose_head(planning: PlanningSetup) -> None:
    pose = np.array(planning.scenario.head_to_world)
    pose[:3, 3] /= MM_PER_M
    planning.collision.set_head_pose(pose)


def _distance_mm(planning: PlanningSetup, position: np.ndarray) -> float:
    """Return the signed distance of a point (3,), RAS mm, to the head: below zero inside."""
    world = transforms.apply(planning.scenario.head_to_world, position) / MM_PER_M
    return MM_PER_M * planning.collision.nearest_to_point(tuple(world.tolist())).distance_m


def check_scenario(folder: Path) -> list[str]:
    """Return a sentence for each error in the set-up, the plan and the tasks of a scenario.

    Raises:
        InputError: it cannot be read at all.
    """
    scenario = checked_scenario(folder)
    mesh = read_head_mesh(scenario.head_mesh)
    wrong = []
    if mesh.euler_characteristic != 2:
        wrong.append("The head's surface has tunnels or loose parts; the skin must be one body.")
    planning = PlanningSetup(scenario, mesh)
    wrong += check_plan(planning) + check_procedures(planning)
    return wrong + check_tasks(planning, scenario.tasks)
