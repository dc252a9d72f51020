"""A procedure from a file of its own: measured on the head of a scenario, and brought into it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.number_text import fixed
from rastrainer.procedure.checks import LineMeasures, measure_lines
from rastrainer.procedure.plan import NO_GO_FOLDER, Procedure, read_all_no_go, read_procedure_meshes
from rastrainer.scenario.scenario import Scenario, load_scenario
from rastrainer_simulator.authoring.planning_setup import PlanningSetup
from rastrainer_simulator.authoring.procedure_check import check_procedure_on_head, lines_held


@dataclass(frozen=True)
class MeasuredProcedure:
    """A procedure as it would be on a head.

    Attributes:
        procedure: the plan.
        lines: measured, in its order.
        is_held: whether the robot can hold the guide on each line; None where the plan is wrong
            apart from that, and the reach was not tried.
        wrong: a sentence for each error.
    """

    procedure: Procedure
    lines: tuple[LineMeasures, ...]
    is_held: tuple[bool | None, ...]
    wrong: tuple[str, ...]

    def to_json(self) -> dict[str, Any]:
        """Return everything, ready for JSON."""
        return {
            "procedure": self.procedure.name,
            "title": self.procedure.title,
            "lines": [
                {**line.to_json(), "isHeld": is_held}
                for line, is_held in zip(self.lines, self.is_held, strict=True)
            ],
            "wrong": list(self.wrong),
        }


def measure_procedures(
    folder: Path, procedure: Procedure | None = None
) -> tuple[MeasuredProcedure, ...]:
    """Return the procedures of a scenario, or another one on its head, as measured.

    Args:
        folder: of the scenario.
        procedure: in the place of the scenario's own.

    Raises:
        InputError: the scenario cannot be read, has no skull, or a mesh is unusable.
    """
    scenario = load_scenario(folder)
    skull = _skull(scenario)
    planning = PlanningSetup(scenario, read_head_mesh(scenario.head_mesh))
    procedures = scenario.procedures if procedure is None else (procedure,)
    return tuple(_measured(planning, each, skull) for each in procedures)


def _measured(planning: PlanningSetup, procedure: Procedure, skull: Path) -> MeasuredProcedure:
    wrong = check_procedure_on_head(planning, procedure)
    held: list[bool | None] = [None] * len(procedure.trajectories)
    unreachable: list[str] = []
    if not wrong:
        held[:], unreachable = lines_held(planning, procedure)
    return MeasuredProcedure(
        procedure,
        tuple(measure_lines(procedure, read_procedure_meshes(procedure, skull))),
        tuple(held),
        (*wrong, *unreachable),
    )


def with_procedure(
    scenario: Scenario, procedure: Procedure
) -> tuple[Scenario, dict[str, HeadMesh]]:
    """Return a scenario with a procedure, in the place of one of the same name.

    Returns:
        The scenario, and the meshes of all its no-go structures by file name. A new mesh whose file
        name another procedure has for another structure gets a name of its own.

    Raises:
        InputError: the scenario has no skull, or a mesh is unusable.
    """
    _skull(scenario)
    others = [each for each in scenario.procedures if each.name != procedure.name]
    kept = read_all_no_go(others)
    structures = []
    for structure in procedure.no_go:
        name, mesh = structure.mesh.name, read_head_mesh(structure.mesh)
        stem = structure.mesh.stem
        numbers = count(2)
        while name in kept and not _same(kept[name], mesh):
            name = f"{stem[:36]}-{next(numbers)}.ply"
        kept[name] = mesh
        structures.append(replace(structure, mesh=Path(NO_GO_FOLDER, name)))
    placed = replace(procedure, no_go=tuple(structures))
    names = [each.name for each in scenario.procedures]
    procedures = list(scenario.procedures)
    if procedure.name in names:
        procedures[names.index(procedure.name)] = placed
    else:
        procedures.append(placed)
    return replace(scenario, procedures=tuple(procedures)), kept


def _same(one: HeadMesh, other: HeadMesh) -> bool:
    pairs = ((one.vertices, other.vertices), (one.triangles, other.triangles))
    return all(a.shape == b.shape and bool((a == b).all()) for a, b in pairs)


def _skull(scenario: Scenario) -> Path:
    if scenario.skull_mesh is None:
        raise InputError(
            f"The scenario {scenario.name} has no skull, which a procedure needs for drilling; "
            "make it again with a skull."
        )
    return scenario.skull_mesh


HEADER = (
    *("line", "length (mm)", "angle to the skull (°)", "nearest no-go structure (mm)"),
    *("nearest other line (mm)", "reach"),
)
REACH = {True: "yes", False: "no", None: "not tried"}


def line_table(procedures: Iterable[MeasuredProcedure]) -> list[str]:
    """Return the lines of a text: each procedure with its table, and what is wrong with it."""
    text = []
    for measured in procedures:
        rows = [HEADER]
        for line, is_held in zip(measured.lines, measured.is_held, strict=True):
            rows.append((*_cells(line), REACH[is_held]))
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        text.append(f"{measured.procedure.title} ({measured.procedure.name})")
        for row in rows:
            cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
            text.append("  ".join(cells).rstrip())
        text += [*measured.wrong, ""]
    return text[:-1] or ["The scenario has no procedure."]


def _cells(line: LineMeasures) -> tuple[str, str, str, str, str]:
    angle = line.skull_angle_deg
    near, other = line.nearest_no_go, line.nearest_line_mm
    return (
        line.name,
        fixed(line.length_mm, 1),
        "–" if angle is None else fixed(angle, 1),
        f"{fixed(line.no_go_mm[near], 1)} {near}" if near else "–",
        "–" if other is None else f"{fixed(other, 1)} {line.nearest_line}",
    )
