"""The points of a plan as the user places, removes and restores them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import vtk

from rastrainer.errors import InputError
from rastrainer.slicer.scene.nodes import ROLE_ATTRIBUTE, Role, findOrAddNode, nodesOf
from rastrainer.slicer.translation import _

SELECTION = "vtkMRMLSelectionNodeSingleton"
INTERACTION = "vtkMRMLInteractionNodeSingleton"


def startPlacing(scene: Any, node: Any) -> None:
    selection, interaction = scene.GetNodeByID(SELECTION), scene.GetNodeByID(INTERACTION)
    selection.SetReferenceActivePlaceNodeClassName(node.GetClassName())
    selection.SetActivePlaceNodeID(node.GetID())
    interaction.SetPlaceModePersistence(False)
    interaction.SetCurrentInteractionMode(interaction.Place)


def stopPlacing(scene: Any) -> None:
    """Stop placing points by clicks; a point that only follows the mouse is removed."""
    interaction = scene.GetNodeByID(INTERACTION)
    if interaction.GetCurrentInteractionMode() == interaction.Place:
        interaction.SetCurrentInteractionMode(interaction.ViewTransform)


TARGET_COLOR = (0.85, 0.2, 0.55)
LIST, LINE = "vtkMRMLMarkupsFiducialNode", "vtkMRMLMarkupsLineNode"
ENDS = 2


class PlanPoints:
    """Adds points to plans and removes them; each change can be undone, the last one first.

    Placing more points never erases placed ones.

    Attributes:
        changes: the changes that can be undone: the node's ID, and a function that undoes the
            change of the node, and returns whether there was anything to undo.
    """

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self.changes: list[tuple[str, Callable[[Any], bool]]] = []

    def newTarget(self) -> Any:
        node = findOrAddNode(self._scene, LIST, Role.PLAN_TARGET, _("Planned target"))
        return self._readyToPlace(node)

    def newTrajectory(self) -> Any:
        """Return a line that lacks its entry or target, for the next clicks."""
        lines = nodesOf(self._scene, LINE, Role.PLAN_TRAJECTORY)
        node = next((line for line in lines if len(placedRows(line)) < ENDS), None)
        if node is None:
            name = self._scene.GenerateUniqueName(_("Planned trajectory"))
            node = self._scene.AddNewNodeByClass(LINE, name)
            node.SetAttribute(ROLE_ATTRIBUTE, Role.PLAN_TRAJECTORY)
            node.CreateDefaultDisplayNodes()
        return self._readyToPlace(node)

    def remove(self, node: Any | None, row: int = -1) -> None:
        """Remove one of a node's placed points, the last where left out."""
        problem = whyNotRemoved(node)
        if node is None or problem:
            raise InputError(problem)
        stopPlacing(self._scene)
        index = placedRows(node)[row]
        label = node.GetNthControlPointLabel(index)
        position = vtk.vtkVector3d(*node.GetNthControlPointPosition(index))
        node.RemoveNthControlPoint(index)

        def insert(node: Any) -> bool:
            node.InsertControlPoint(min(index, node.GetNumberOfControlPoints()), position, label)
            return True

        self.changes.append((node.GetID(), insert))

    def undo(self) -> None:
        """Undo the last placing or removal whose node still exists."""
        stopPlacing(self._scene)
        while self.changes:
            nodeId, undoChange = self.changes.pop()
            node = self._scene.GetNodeByID(nodeId)
            if node is not None and undoChange(node):
                return

    def _readyToPlace(self, node: Any) -> Any:
        display = node.GetDisplayNode()
        display.SetSelectedColor(TARGET_COLOR)
        display.SetOccludedVisibility(True)
        count = node.GetNumberOfDefinedControlPoints()

        def removeNew(node: Any) -> bool:
            added = placedRows(node)[count:]
            for index in reversed(added):
                node.RemoveNthControlPoint(index)
            return bool(added)

        self.changes.append((node.GetID(), removeNew))
        return node


def placedRows(node: Any | None) -> Sequence[int]:
    """Return which points of a node are placed, and not only under the mouse."""
    if node is None:
        return []
    return [
        row
        for row in range(node.GetNumberOfControlPoints())
        if node.GetNthControlPointPositionStatus(row) == node.PositionDefined
    ]


def whyNotRemoved(node: Any | None) -> str:
    """Return why no point of a node can be removed, empty where one can."""
    if node is None or not placedRows(node):
        return _("No point is placed.")
    if node.GetLocked():
        return _("These points belong to the scenario; unlock the list in the module Markups.")
    return ""
