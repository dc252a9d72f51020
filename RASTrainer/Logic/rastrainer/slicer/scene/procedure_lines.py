"""The lines of a procedure: planned by the user, by the registration, and as they truly became.

A planned line's instrument, and which nodes are no-go structures, is noted on the nodes, so that
it is saved with the scene.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import vtk

from rastrainer.head.mesh import HeadMesh
from rastrainer.procedure.errors import ProcedureAnalysis, SplitError, TrajectoryErrors, TrueLine
from rastrainer.procedure.plan import Procedure
from rastrainer.slicer.polydata import meshPolyData
from rastrainer.slicer.scene import nodes
from rastrainer.slicer.scene.error_colors import arrowPolyData
from rastrainer.slicer.scene.nodes import NodeKind, Role
from rastrainer.slicer.scene.plan_points import ENDS, placedPoints
from rastrainer.slicer.scene.tables import Columns, showTable
from rastrainer.slicer.translation import _

DIAMETER_ATTRIBUTE, SAFETY_ATTRIBUTE = "RASTrainer.diameterMm", "RASTrainer.safetyMm"
NO_GO_ATTRIBUTE = "RASTrainer.noGo"
ORDER_ATTRIBUTE, LAST = "RASTrainer.order", 1e6
"""A line that was never moved comes after those that were, in the order of the scene."""
USUAL_DIAMETER_MM, USUAL_SAFETY_MM = 1.3, 2.0


def planLines(scene: Any) -> list[Any]:
    lines = Role.PLAN_LINE.all(scene)
    return sorted(lines, key=lambda line: float(line.GetAttribute(ORDER_ATTRIBUTE) or LAST))


def placeLine(scene: Any, line: Any, place: int) -> None:
    """Give a line a place in the order of the plan, and restore it if it was removed."""
    if line.GetScene() is None:
        scene.AddNode(line)
        line.CreateDefaultDisplayNodes()
    lines = [each for each in planLines(scene) if each is not line]
    for number, each in enumerate([*lines[:place], line, *lines[place:]]):
        each.SetAttribute(ORDER_ATTRIBUTE, str(number))


def instrumentOf(line: Any) -> tuple[float, float]:
    """Return diameter and safety distance of a line's instrument, mm."""
    diameter, safety = line.GetAttribute(DIAMETER_ATTRIBUTE), line.GetAttribute(SAFETY_ATTRIBUTE)
    return float(diameter or USUAL_DIAMETER_MM), float(safety or USUAL_SAFETY_MM)


def setInstrument(line: Any, diameterMm: float, safetyMm: float) -> None:
    line.SetAttribute(DIAMETER_ATTRIBUTE, f"{diameterMm:g}")
    line.SetAttribute(SAFETY_ATTRIBUTE, f"{safetyMm:g}")


def lengthMm(line: Any) -> float | None:
    """Return the length of a line; None while one of its ends is missing."""
    return line.GetLineLengthWorld() if len(placedPoints(line)) == ENDS else None


def showPlan(scene: Any, procedure: Procedure | None, noGo: Mapping[str, HeadMesh]) -> None:
    """Replace the plan in the scene by another one, or an empty one, to be changed there."""
    for line in planLines(scene):
        nodes.removeNode(line)
    for node in noGoNodes(scene):
        setNoGo(node, False)
        if node.GetAttribute(nodes.ROLE_ATTRIBUTE) == Role.NO_GO.role:
            nodes.removeNode(node)
    for trajectory in () if procedure is None else procedure.trajectories:
        line = Role.PLAN_LINE.add(scene, trajectory.name)
        setInstrument(line, trajectory.diameter_mm, trajectory.safety_mm)
        ends = trajectory.entry_ras, trajectory.target_ras
        nodes.setPoints(line, (_("Entry"), _("Target")), ends)
    for name, mesh in noGo.items():
        model = Role.NO_GO.add(scene, name)
        model.SetAndObservePolyData(meshPolyData(mesh))
        setNoGo(model, True)
    checkpoints = () if procedure is None else procedure.checkpoints
    places = [checkpoint.position_ras for checkpoint in checkpoints]
    names = [checkpoint.name for checkpoint in checkpoints]
    nodes.setPoints(Role.CHECKPOINTS.make(scene), names, places)


def noGoNodes(scene: Any) -> list[Any]:
    found = nodes.nodesOfClass(scene, nodes.MODEL) + nodes.nodesOfClass(scene, nodes.SEGMENTATION)
    return [node for node in found if isNoGo(node)]


def isNoGo(node: Any) -> bool:
    return node.GetAttribute(NO_GO_ATTRIBUTE) == "yes"


def setNoGo(node: Any, isNoGoNow: bool) -> None:
    node.SetAttribute(NO_GO_ATTRIBUTE, "yes" if isNoGoNow else None)


THICKNESS = 0.3
"""Thickness of the arrows, which are true to scale, relative to arrows of residuals."""


def showPlannedLines(scene: Any, procedure: Procedure | None) -> None:
    """Show the planned lines of a procedure in the head; they replace other planned lines.

    The errors of an earlier procedure are removed. None removes all lines.
    """
    former = Role.REGISTERED_LINE, Role.TRUE_LINE, Role.PROCEDURE_ERRORS
    for kind in (*former, Role.ERRORS_BY_REGISTRATION, Role.ERRORS_BY_HAND):
        kind.remove(scene)
    planned = [] if procedure is None else procedure.trajectories
    lines = {each.name: (each.entry_ras, each.target_ras) for each in planned}
    _showLines(scene, Role.PLANNED_LINE, lines)


def showProcedureErrors(scene: Any, analysis: ProcedureAnalysis, lines: Sequence[TrueLine]) -> Any:
    """Show all lines of a procedure, arrows of its errors, and their table, which is returned.

    The registered lines are the true positions of the plan as the trainee saw it. At entry and
    target, an arrow leads from the planned point to its registered position, and another from there
    to the reached point; both are true to scale.
    """
    _showLines(scene, Role.PLANNED_LINE, {each.trajectory: each.planned for each in lines})
    _showLines(scene, Role.REGISTERED_LINE, {each.trajectory: each.shown for each in lines})
    _showLines(scene, Role.TRUE_LINE, {each.trajectory: each.placed for each in lines})
    each = analysis.trajectories
    byRegistration, byHand = vtk.vtkAppendPolyData(), vtk.vtkAppendPolyData()
    for errors, line in zip(each, lines, strict=True):
        splits = errors.entry_point_error, errors.target_point_error
        for start, split in zip(line.planned, splits, strict=True):
            shift, rest = np.array(split.by_registration_ras), np.array(split.by_hand_ras)
            byRegistration.AddInputData(arrowPolyData(start, shift, THICKNESS))
            byHand.AddInputData(arrowPolyData(start + shift, rest, THICKNESS))
    arrows = {Role.ERRORS_BY_REGISTRATION: byRegistration, Role.ERRORS_BY_HAND: byHand}
    for kind, append in arrows.items():
        append.Update()
        kind.make(scene).SetAndObservePolyData(append.GetOutput())
    return showTable(scene, Role.PROCEDURE_ERRORS, _columns(each))


def _showLines(scene: Any, kind: NodeKind, lines: Mapping[str, Any]) -> None:
    """Show lines of a kind, in place of others; ends are (2, 3) float, RAS mm, by name."""
    kind.remove(scene)
    for name, ends in lines.items():
        # Only the planned lines show a label, at their entries.
        nodes.setPoints(kind.add(scene, kind.name.format(name)), (name, ""), ends)


def _columns(each: Sequence[TrajectoryErrors]) -> Columns:
    def parts(title: str, splits: Sequence[SplitError]) -> dict[str, list[float]]:
        return {
            f"{title} (mm)": [split.mm for split in splits],
            f"{title}, by registration (mm)": [split.by_registration_mm for split in splits],
            f"{title}, by hand or robot (mm)": [split.by_hand_mm for split in splits],
        }

    return {
        "trajectory": [errors.trajectory for errors in each],
        "aligned by": ["robot" if errors.self_aligned else "hand" for errors in each],
        **parts("entry point error", [errors.entry_point_error for errors in each]),
        **parts("target point error", [errors.target_point_error for errors in each]),
        "radial error (mm)": [errors.radial_error.mm for errors in each],
        "depth error (mm)": [errors.depth_error_mm for errors in each],
        "depth error, by registration (mm)": [e.depth_error_by_registration_mm for e in each],
        "depth error, by hand (mm)": [errors.depth_error_by_hand_mm for errors in each],
        "angular deviation (°)": [errors.angular_deviation_deg for errors in each],
        "angle by registration (°)": [e.angular_deviation_by_registration_deg for e in each],
        "angle by hand or robot (°)": [e.angular_deviation_by_hand_deg for e in each],
        "plunge depth (mm)": [errors.plunge_mm for errors in each],
        "distance kept (mm)": [min(e.kept_mm.values(), default=None) for e in each],
        "alignments": [float(errors.alignments) for errors in each],
    }
