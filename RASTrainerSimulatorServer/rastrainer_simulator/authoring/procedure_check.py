"""Check the procedures of a scenario: their plans, and the reach of the guide along each line."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import read_head_mesh
from rastrainer.procedure.checks import check_procedure
from rastrainer.procedure.plan import Procedure, ProcedureTrajectory, read_procedure_meshes
from rastrainer.scenario.library import require_usable_lines
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.authoring.planning_setup import PlanningSetup
from rastrainer_simulator.collision.touch_planner import PlanReach
from rastrainer_simulator.core.setup import SimulationSetup

STAND_OFFS_M = (0.01, 0.03, 0.05, 0.08)
"""Of the guide's tip from the entry: where it may be locked, and the way there."""
POSES_TRIED = 12


class GuideReach:
    """Tells where the robot can hold the guide."""

    def __init__(self, planning: PlanningSetup) -> None:
        """`planning` has the robot and the head; its collision takes on the poses."""
        self._collision = planning.collision
        self._reach = PlanReach(planning.setup.robot, planning.kinematics, planning.collision)

    def is_held(self, trajectory: ProcedureTrajectory, poses: Iterable[np.ndarray]) -> bool:
        """Return whether the guide can be held along a line before the head in all its poses.

        Args:
            trajectory: planned, RAS mm.
            poses: HeadToWorld, (4, 4) float, mm, one after the other.
        """
        return all(self._is_held(trajectory, pose) for pose in poses)

    def _is_held(self, trajectory: ProcedureTrajectory, head_to_world: np.ndarray) -> bool:
        pose = np.array(head_to_world, dtype=float)
        pose[:3, 3] /= MM_PER_M
        self._collision.set_head_pose(pose)
        entry = transforms.apply(pose, trajectory.entry / MM_PER_M)
        direction = pose[:3, :3] @ trajectory.direction
        return self._reach.judge_guide(entry.tolist(), direction.tolist(), STAND_OFFS_M).reachable


def check_procedures(planning: PlanningSetup) -> list[str]:
    """Return a sentence for each error in the procedures of a scenario.

    Reach is checked in the nominal pose of the head and in those of some seeds.
    """
    wrong = []
    for procedure in planning.scenario.procedures:
        try:
            wrong += _check(planning, procedure)
        except InputError as error:
            wrong.append(f"{procedure.title}: {error}")
    return wrong


def require_usable_procedures(setup: SimulationSetup) -> None:
    """Check the procedures of a scenario that is loaded: their lines, and the reach along them.

    It takes a second; the scenario has procedures. Only the nominal pose of the
    head is tried, and distances are not checked: `rastrainer scenario check` does both.

    Raises:
        InputError: a procedure cannot be carried out.
    """
    scenario = setup.scenario
    require_usable_lines(scenario)
    planning = PlanningSetup(scenario, read_head_mesh(scenario.head_mesh), setup)
    wrong = [
        sentence
        for procedure in scenario.procedures
        for sentence in unreachable_lines(planning, procedure, range(0))
    ]
    if wrong:
        raise InputError(" ".join(wrong))


def _check(planning: PlanningSetup, procedure: Procedure) -> list[str]:
    wrong = check_procedure_on_head(planning, procedure)
    return wrong or unreachable_lines(planning, procedure, range(POSES_TRIED))


def check_procedure_on_head(planning: PlanningSetup, procedure: Procedure) -> list[str]:
    """Return a sentence for each error of a plan on the scenario's head, apart from the reach.

    Raises:
        InputError: a mesh is unusable.
    """
    skull = planning.scenario.skull_mesh
    assert skull is not None, "a scenario with procedures has a skull"
    return check_procedure(procedure, planning.mesh, read_procedure_meshes(procedure, skull))


def unreachable_lines(planning: PlanningSetup, procedure: Procedure, seeds: range) -> list[str]:
    """Return a sentence for each line of a procedure on which the guide cannot be held."""
    return _lines_held(planning, procedure, seeds)[1]


def lines_held(planning: PlanningSetup, procedure: Procedure) -> tuple[list[bool], list[str]]:
    """Return whether the guide can be held on each line, and a sentence for each on which not."""
    return _lines_held(planning, procedure, range(POSES_TRIED))


def _lines_held(
    planning: PlanningSetup, procedure: Procedure, seeds: range
) -> tuple[list[bool], list[str]]:
    reach, held, wrong = GuideReach(planning), [], []
    nominal, *others = planning.poses(seeds)
    for trajectory in procedure.trajectories:
        where = ""
        if not reach.is_held(trajectory, [nominal]):
            where = "where the head is"
        elif not reach.is_held(trajectory, others):
            where = "in every trial"
        held.append(not where)
        if where:
            wrong.append(
                f"{procedure.title}: the robot cannot hold the guide on the line of "
                f"{trajectory.name} {where}; choose another entry, or move the head."
            )
    return held, wrong
