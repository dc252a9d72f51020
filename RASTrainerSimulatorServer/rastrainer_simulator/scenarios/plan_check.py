"""Does what is planned lie in the head, and can the robot carry it out?"""

from __future__ import annotations

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head_mesh import HeadMesh
from rastrainer.scenario import Scenario
from rastrainer_simulator.planning.plan_reach import PlanReach
from rastrainer_simulator.planning.workbench import Workbench
from rastrainer_simulator.scenarios.standing_check import check_standing
from rastrainer_simulator.settings import SimulationSettings
from rastrainer_simulator.start_posture import start_joints

MM = 1000.0
ENTRY_OFF_SKIN_MM = 10.0
"""Many plan the entry on the bone, below some 7 mm of scalp, or click a little beside the skin."""


def check_plan(bench: Workbench) -> list[str]:
    """Return what is wrong with the set-up, the targets and the trajectory, one sentence each."""
    scenario = bench.scenario
    wrong = check_standing(scenario, bench.mesh)
    height = SimulationSettings().start_height
    if start_clearance_mm(scenario, bench.mesh) <= 0.0:
        wrong.append(
            f"A trial starts {MM * height:.0f} mm above {scenario.target_name}: that is within the "
            "head. Let another target be the first."
        )
    try:
        start_joints(bench.setup.robot, scenario, height)
    except InputError as error:
        wrong.append(str(error))
    _pose_head(bench)
    targets = [(scenario.target_name, scenario.target_position)]
    targets += [(target.name, target.position) for target in scenario.targets]
    if scenario.trajectory is not None:
        targets.append((scenario.trajectory.name, scenario.trajectory.target))
    for name, position in targets:
        depth = -_distance_mm(bench, position)
        if depth < 0.0:
            wrong.append(f"{name} is {-depth:.0f} mm outside of the head.")
    return wrong or _wrong_trajectory(bench)


def start_clearance_mm(scenario: Scenario, head: HeadMesh) -> float:
    """Return how far above the head's highest place the tip is where a trial starts, at least."""
    top = transforms.apply(scenario.head_to_world, head.vertices)[:, 2].max()
    target = transforms.apply(scenario.head_to_world, scenario.target_position)[2]
    return float(target + MM * SimulationSettings().start_height - top)


def _wrong_trajectory(bench: Workbench) -> list[str]:
    trajectory = bench.scenario.trajectory
    if trajectory is None:
        return []
    off_skin = _distance_mm(bench, trajectory.entry)
    if abs(off_skin) > ENTRY_OFF_SKIN_MM:
        side = "above the skin" if off_skin > 0.0 else "below the skin, within the head"
        return [
            f"{trajectory.name} enters {abs(off_skin):.0f} mm {side}; its entry must be within "
            f"{ENTRY_OFF_SKIN_MM:g} mm of the skin."
        ]
    to_world = bench.scenario.head_to_world
    entry, target = (
        transforms.apply(to_world, point) / MM for point in (trajectory.entry, trajectory.target)
    )
    reach = PlanReach(bench.setup.robot, bench.kinematics, bench.collision)
    answer = reach.judge(target, entry)
    return [] if answer.reachable else [f"{trajectory.name}: {answer.reason}"]


def _pose_head(bench: Workbench) -> None:
    pose = np.array(bench.scenario.head_to_world)
    pose[:3, 3] /= MM
    bench.collision.set_head_pose(pose)


def _distance_mm(bench: Workbench, position: np.ndarray) -> float:
    """Return the signed distance of a point (3,), RAS mm, to the head: below zero inside."""
    world = transforms.apply(bench.scenario.head_to_world, position) / MM
    return MM * bench.collision.nearest_to_point(tuple(world.tolist())).distance_m
