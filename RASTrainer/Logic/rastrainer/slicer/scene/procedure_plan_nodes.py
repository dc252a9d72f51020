"""The plan of a procedure in the scene: lines that the user places, and what to keep away from.

A line's instrument, and which nodes are no-go structures, is noted on the nodes, so that it is
saved with the scene.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer.head.mesh import HeadMesh
from rastrainer.procedure.plan import Checkpoint, ProcedureTrajectory
from rastrainer.slicer.scene.control_points import setPoints, worldPoints
from rastrainer.slicer.scene.plan_points import ENDS, TARGET_COLOR, placedRows
from rastrainer.slicer.scene.scenario_nodes import trianglesPolyData
from rastrainer.slicer.scene.scene import ROLE_ATTRIBUTE, Role, findOrAddNode, nodesOf, nodesOfClass
from rastrainer.slicer.translation import _

LINE, FIDUCIALS = "vtkMRMLMarkupsLineNode", "vtkMRMLMarkupsFiducialNode"
MODEL, SEGMENTATION = "vtkMRMLModelNode", "vtkMRMLSegmentationNode"
DIAMETER_ATTRIBUTE, SAFETY_ATTRIBUTE = "RASTrainer.diameterMm", "RASTrainer.safetyMm"
NO_GO_ATTRIBUTE = "RASTrainer.noGo"
ORDER_ATTRIBUTE, LAST = "RASTrainer.order", 1e6
"""A line that was never moved comes after those that were, in the order of the scene."""
USUAL_DIAMETER_MM, USUAL_SAFETY_MM = 1.3, 2.0
NO_GO_COLOR = (0.8, 0.2, 0.2)


def planLines(scene: Any) -> list[Any]:
    """Return the lines of the plan, in the order in which they are carried out."""
    lines = nodesOf(scene, LINE, Role.PLAN_LINE)
    return sorted(lines, key=lambda line: _number(line.GetAttribute(ORDER_ATTRIBUTE), LAST))


def raiseLine(scene: Any, line: Any) -> None:
    """Have a line of the plan carried out before the one above it; the first one stays."""
    lines = planLines(scene)
    place = lines.index(line)
    if place > 0:
        lines[place - 1 : place + 1] = [line, lines[place - 1]]
    _noteOrder(lines)


def newPlanLine(scene: Any) -> Any:
    """Return a line of the plan that lacks its entry or target, for the next clicks."""
    unfinished = [line for line in planLines(scene) if len(placedRows(line)) < ENDS]
    return unfinished[0] if unfinished else _addLine(scene, scene.GenerateUniqueName(_("Line")))


@dataclass(frozen=True)
class RemovedLine:
    """A line that was removed from the plan.

    Attributes:
        name: of the line.
        ends: (n, 3) float, RAS mm; n is 2 unless it was not placed completely.
        instrument: diameter and safety distance, mm.
        place: among the lines of the plan, from 0.
    """

    name: str
    ends: np.ndarray
    instrument: tuple[float, float]
    place: int


def removeLine(scene: Any, line: Any) -> RemovedLine:
    """Remove a line from the plan; return what `restoreLine` needs to bring it back."""
    place = planLines(scene).index(line)
    removed = RemovedLine(line.GetName(), worldPoints(line), instrumentOf(line), place)
    scene.RemoveNode(line)
    return removed


def restoreLine(scene: Any, removed: RemovedLine) -> None:
    """Bring a removed line back to its place among the others."""
    lines = planLines(scene)
    line = _addLine(scene, removed.name)
    setInstrument(line, *removed.instrument)
    setPoints(line, (_("Entry"), _("Target"))[: len(removed.ends)], removed.ends)
    lines.insert(removed.place, line)
    _noteOrder(lines)


def instrumentOf(line: Any) -> tuple[float, float]:
    """Return diameter and safety distance of a line's instrument, mm."""
    usual = (DIAMETER_ATTRIBUTE, USUAL_DIAMETER_MM), (SAFETY_ATTRIBUTE, USUAL_SAFETY_MM)
    diameter, safety = (_number(line.GetAttribute(name), value) for name, value in usual)
    return diameter, safety


def setInstrument(line: Any, diameterMm: float, safetyMm: float) -> None:
    """Note diameter and safety distance of a line's instrument, mm."""
    line.SetAttribute(DIAMETER_ATTRIBUTE, f"{diameterMm:g}")
    line.SetAttribute(SAFETY_ATTRIBUTE, f"{safetyMm:g}")


def lengthMm(line: Any) -> float | None:
    """Return the length of a line; None while one of its ends is missing."""
    if len(placedRows(line)) < ENDS:
        return None
    ends = worldPoints(line)
    return float(np.linalg.norm(ends[1] - ends[0]))


def showPlan(
    scene: Any,
    trajectories: tuple[ProcedureTrajectory, ...],
    noGo: dict[str, HeadMesh],
    checkpoints: tuple[Checkpoint, ...],
) -> None:
    """Replace the plan in the scene by another one, to be changed there.

    Models that were shown for the earlier plan are removed; what the user has marked is no longer
    marked.
    """
    for line in planLines(scene):
        scene.RemoveNode(line)
    for node in noGoNodes(scene):
        setNoGo(node, False)
        if node.GetAttribute(ROLE_ATTRIBUTE) == Role.NO_GO:
            scene.RemoveNode(node)
    for trajectory in trajectories:
        line = _addLine(scene, trajectory.name)
        setInstrument(line, trajectory.diameter_mm, trajectory.safety_mm)
        setPoints(line, (_("Entry"), _("Target")), np.array([trajectory.entry, trajectory.target]))
    for name, mesh in noGo.items():
        model = scene.AddNewNodeByClass(MODEL, name)
        model.SetAttribute(ROLE_ATTRIBUTE, Role.NO_GO)
        model.SetAndObservePolyData(trianglesPolyData(mesh.vertices, mesh.triangles))
        model.CreateDefaultDisplayNodes()
        model.GetDisplayNode().SetColor(NO_GO_COLOR)
        model.GetDisplayNode().SetVisibility2D(True)
        setNoGo(model, True)
    node = checkpointList(scene)
    names = [checkpoint.name for checkpoint in checkpoints]
    places = [checkpoint.position for checkpoint in checkpoints]
    setPoints(node, names, np.array(places, dtype=float).reshape(-1, 3))


def checkpointList(scene: Any) -> Any:
    """Return the list of the plan's checkpoints, an empty one where there is none yet."""
    return findOrAddNode(scene, FIDUCIALS, Role.CHECKPOINTS, _("Checkpoints"))


def noGoNodes(scene: Any) -> list[Any]:
    """Return the models and segmentations that are no-go structures."""
    nodes = [*nodesOfClass(scene, MODEL), *nodesOfClass(scene, SEGMENTATION)]
    return [node for node in nodes if isNoGo(node)]


def isNoGo(node: Any) -> bool:
    """Return whether a model or segmentation is a no-go structure."""
    return node.GetAttribute(NO_GO_ATTRIBUTE) == "yes"


def setNoGo(node: Any, isNoGoNow: bool) -> None:
    """Make a model or segmentation a no-go structure, or none."""
    if isNoGoNow:
        node.SetAttribute(NO_GO_ATTRIBUTE, "yes")
    else:
        node.RemoveAttribute(NO_GO_ATTRIBUTE)


def _addLine(scene: Any, name: str) -> Any:
    line = scene.AddNewNodeByClass(LINE, name)
    line.SetAttribute(ROLE_ATTRIBUTE, Role.PLAN_LINE)
    line.CreateDefaultDisplayNodes()
    line.GetDisplayNode().SetSelectedColor(TARGET_COLOR)
    line.GetDisplayNode().SetOccludedVisibility(True)
    setInstrument(line, USUAL_DIAMETER_MM, USUAL_SAFETY_MM)
    return line


def _noteOrder(lines: list[Any]) -> None:
    for number, line in enumerate(lines):
        line.SetAttribute(ORDER_ATTRIBUTE, str(number))


def _number(text: str | None, usual: float) -> float:
    try:
        return float(text or usual)
    except ValueError:
        return usual
