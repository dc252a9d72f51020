"""A procedure on a scenario's head: checked, measured, and added from its own file."""

from __future__ import annotations

from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.procedure.checks import MeasuredProcedure, check_procedure
from rastrainer.procedure.plan import (
    NO_GO_FOLDER,
    Procedure,
    ProcedureTrajectory,
    read_all_no_go,
    read_procedure_meshes,
)
from rastrainer.scenario.library import require_usable_lines
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.authoring.planning_setup import POSES_TRIED, PlanningSetup
from rastrainer_simulator.core.setup import SimulationSetup

STAND_OFFS_M = (0.01, 0.03, 0.05, 0.08)
"""Distances of the guide's tip from the entry: where it may be locked, and on the way there."""


def check_procedures(planning: PlanningSetup) -> list[str]:
    """Return a sentence for each error in the procedures of a scenario."""
    wrong: list[str] = []
    for procedure in planning.scenario.procedures:
        try:
            wrong += measure_procedure(planning, procedure).wrong
        except InputError as error:
            wrong.append(f"{procedure.title}: {error}")
    return wrong


def measure_procedure(planning: PlanningSetup, procedure: Procedure) -> MeasuredProcedure:
    """Return how a procedure would be on the scenario's head.

    Reach is checked in the nominal pose of the head and in some seeded poses.
    """
    meshes = read_procedure_meshes(procedure, skull_of(planning.scenario))
    lines, wrong = check_procedure(procedure, planning.mesh, meshes)
    if not wrong:
        held, wrong = _lines_held(planning, procedure)
        lines = [replace(line, is_held=can) for line, can in zip(lines, held, strict=True)]
    return MeasuredProcedure(procedure.name, procedure.title, tuple(lines), tuple(wrong))


def require_usable_procedures(setup: SimulationSetup) -> None:
    """Check the procedures of a scenario that is loaded: their lines, and the reach along them.

    It takes a second; the scenario has procedures. Only the nominal pose of the
    head is tried, and distances are not checked: `rastrainer scenario check` does both.
    """
    scenario = setup.scenario
    require_usable_lines(scenario)
    planning = PlanningSetup(scenario, read_head_mesh(scenario.head), setup)
    wrong = [
        sentence
        for procedure in scenario.procedures
        for sentence in _lines_held(planning, procedure, poses_tried=0)[1]
    ]
    if wrong:
        raise InputError(" ".join(wrong))


def _lines_held(
    planning: PlanningSetup, procedure: Procedure, poses_tried: int = POSES_TRIED
) -> tuple[list[bool], list[str]]:
    """Return whether the guide can be held on each line, and a sentence for each failure."""
    held, wrong = [], []
    nominal, *others = planning.poses(range(poses_tried))
    for trajectory in procedure.trajectories:

        def is_held(head_to_world: np.ndarray, line: ProcedureTrajectory = trajectory) -> bool:
            pose = planning.place_head(head_to_world)
            entry = transforms.apply(pose, line.entry_ras / MM_PER_M).tolist()
            direction = (pose[:3, :3] @ line.direction).tolist()
            return planning.reach.can_hold_guide(entry, direction, STAND_OFFS_M)

        where = "" if is_held(nominal) else "where the head is"
        if not where and not all(map(is_held, others)):
            where = "in every trial"
        held.append(not where)
        if where:
            wrong.append(
                f"{procedure.title}: the robot cannot hold the guide on the line of "
                f"{trajectory.name} {where}; choose another entry, or move the head."
            )
    return held, wrong


def with_procedure(
    scenario: Scenario, procedure: Procedure
) -> tuple[Scenario, dict[str, HeadMesh]]:
    """Return a scenario with a procedure, in place of one of the same name.

    The second value has the meshes of all its no-go structures by file name. A new mesh gets
    another file name if another procedure uses its name for another structure.
    """
    skull_of(scenario)
    others = [each for each in scenario.procedures if each.name != procedure.name]
    kept = read_all_no_go(others)
    structures = []
    for structure in procedure.no_go:
        name, mesh = structure.file.name, read_head_mesh(structure.file)
        numbers = count(2)
        while name in kept and not (
            np.array_equal(kept[name].vertices, mesh.vertices)
            and np.array_equal(kept[name].triangles, mesh.triangles)
        ):
            name = f"{structure.file.stem[:36]}-{next(numbers)}.ply"
        kept[name] = mesh
        structures.append(replace(structure, file=Path(NO_GO_FOLDER, name)))
    # It replaces the procedure of the same name.
    procedures = {each.name: each for each in scenario.procedures}
    procedures[procedure.name] = replace(procedure, no_go=tuple(structures))
    return replace(scenario, procedures=tuple(procedures.values())), kept


def skull_of(scenario: Scenario) -> Path:
    if scenario.skull is None:
        raise InputError(
            f"The scenario {scenario.name} has no skull, which a procedure needs for drilling; "
            "make it again with a skull."
        )
    return scenario.skull.file
