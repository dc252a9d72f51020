"""The points of plans and landmarks as the user places, removes and restores them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import slicer

from rastrainer.errors import InputError
from rastrainer.slicer.scene.nodes import (
    ROLE_ATTRIBUTE,
    Role,
    findOrAddNode,
    labelOf,
    nodesOf,
    setPoints,
)
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


@dataclass(frozen=True, eq=False)
class PlacedPoints:
    """Labels, positions (n, 3) float, mm, and which points are selected, of a list or a line."""

    labels: tuple[str, ...]
    points: np.ndarray
    selected: tuple[bool, ...]

    @classmethod
    def of(cls, node: Any) -> PlacedPoints:
        rows = placedRows(node)
        return cls(
            tuple(labelOf(node, row) for row in rows),
            slicer.util.arrayFromMarkupsControlPoints(node)[rows],
            tuple(bool(node.GetNthControlPointSelected(row)) for row in rows),
        )

    def isLike(self, other: PlacedPoints) -> bool:
        isSame = (self.labels, self.selected) == (other.labels, other.selected)
        return isSame and np.array_equal(self.points, other.points)

    def without(self, row: int) -> PlacedPoints:
        kept = [each for each in range(len(self.labels)) if each != row % len(self.labels)]
        return PlacedPoints(
            tuple(self.labels[each] for each in kept),
            self.points[kept],
            tuple(self.selected[each] for each in kept),
        )

    def put(self, node: Any) -> None:
        """Replace the points of a list or a line by these."""
        with slicer.util.NodeModify(node):
            setPoints(node, self.labels, self.points)
            for row, isSelected in enumerate(self.selected):
                node.SetNthControlPointSelected(row, isSelected)


class UndoablePoints:
    """Places and removes points; each change can be undone, the last one first."""

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._before: list[tuple[str, PlacedPoints]] = []

    def remember(self, node: Any) -> PlacedPoints:
        """Return the points that are placed, for `undo` to restore; the next click places none."""
        stopPlacing(self._scene)
        present = PlacedPoints.of(node)
        self._before.append((node.GetID(), present))
        return present

    @property
    def canUndo(self) -> bool:
        """Whether a change can be undone."""
        return any(self._changed(*before) is not None for before in self._before)

    def undo(self) -> None:
        """Undo the last change whose list or line still exists."""
        stopPlacing(self._scene)
        while self._before:
            nodeId, before = self._before.pop()
            node = self._changed(nodeId, before)
            if node is not None:
                before.put(node)
                return

    def forget(self) -> None:
        """Forget what could be undone: the scene was closed."""
        self._before.clear()

    def _changed(self, nodeId: str, before: PlacedPoints) -> Any | None:
        """Return a node whose points are different now."""
        node = self._scene.GetNodeByID(nodeId)
        return None if node is None or before.isLike(PlacedPoints.of(node)) else node


class PlanPoints(UndoablePoints):
    """The points of targets and trajectories; placing more never erases placed ones."""

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
        self.remember(node).without(row).put(node)

    def _readyToPlace(self, node: Any) -> Any:
        node.GetDisplayNode().SetSelectedColor(TARGET_COLOR)
        node.GetDisplayNode().SetOccludedVisibility(True)
        self.remember(node)
        return node


def placedRows(node: Any | None) -> list[int]:
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
