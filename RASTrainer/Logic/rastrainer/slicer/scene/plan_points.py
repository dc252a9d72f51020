"""The points of plans and landmarks as the user places, removes and restores them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import starmap
from typing import Any, NamedTuple

import slicer

from rastrainer.errors import InputError
from rastrainer.slicer.scene.nodes import LINE, NodeKind, labelsOf, placingNodes, setPoints
from rastrainer.slicer.translation import _


def startPlacing(scene: Any, node: Any) -> None:
    selection, interaction = placingNodes(scene)
    selection.SetReferenceActivePlaceNodeClassName(node.GetClassName())
    selection.SetActivePlaceNodeID(node.GetID())
    interaction.SetPlaceModePersistence(False)
    interaction.SetCurrentInteractionMode(interaction.Place)


def stopPlacing(scene: Any) -> None:
    """Stop placing points by clicks; a point that only follows the mouse is removed."""
    _selection, interaction = placingNodes(scene)
    if interaction.GetCurrentInteractionMode() == interaction.Place:
        interaction.SetCurrentInteractionMode(interaction.ViewTransform)


ENDS = 2
"""Points of a line: its entry and its target."""


class PlacedPoint(NamedTuple):
    """A point of a list or a line, mm, in its own frame or RAS."""

    label: str
    position: Sequence[float]
    isSelected: bool = True


def placedPoints(node: Any | None, inRas: bool = False) -> list[PlacedPoint]:
    """Return the points of a node that are placed, and not only under the mouse."""
    if node is None:
        return []
    place = node.GetNthControlPointPositionWorld if inRas else node.GetNthControlPointPosition
    return [
        PlacedPoint(label, place(row), bool(node.GetNthControlPointSelected(row)))
        for row, label in enumerate(labelsOf(node))
        if node.GetNthControlPointPositionStatus(row) == node.PositionDefined
    ]


def unfinishedLine(scene: Any, kind: NodeKind) -> Any:
    """Return the first line of a kind that lacks its entry or target, or a new one."""
    unfinished = (line for line in kind.all(scene) if len(placedPoints(line)) < ENDS)
    return next(unfinished, None) or kind.add(scene, scene.GenerateUniqueName(kind.name))


def putPoints(node: Any, points: Sequence[PlacedPoint]) -> None:
    with slicer.util.NodeModify(node):
        setPoints(node, [point.label for point in points], [point.position for point in points])
        for row, point in enumerate(points):
            node.SetNthControlPointSelected(row, point.isSelected)


class UndoablePoints:
    """Places and removes points; each change can be undone, the last one first.

    Placing more never erases any.
    """

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._before: list[tuple[Any, list[PlacedPoint]]] = []

    def remember(self, node: Any) -> list[PlacedPoint]:
        """Return the placed points, which `undo` will restore; the next click places none."""
        stopPlacing(self._scene)
        points = placedPoints(node)
        # Closing a scene releases its nodes.
        self._before = [each for each in self._before if each[0].GetScene() is not None]
        self._before.append((node, list(points)))
        return points

    @property
    def canUndo(self) -> bool:
        return any(starmap(_isChanged, self._before))

    def ready(self, kind: NodeKind) -> Any:
        """Return the list of a kind, or its line that lacks its entry or target, to be placed."""
        isLine = kind.className == LINE
        node = unfinishedLine(self._scene, kind) if isLine else kind.make(self._scene)
        self.remember(node)
        return node

    def removePoint(self, node: Any | None, row: int = -1) -> None:
        """Remove one of a node's placed points, the last where left out."""
        problem = whyNotRemoved(node)
        if node is None or problem:
            raise InputError(problem)
        points = self.remember(node)
        del points[row]
        putPoints(node, points)

    def undo(self) -> None:
        """Undo the last change whose list or line still exists."""
        stopPlacing(self._scene)
        while self._before:
            node, before = self._before.pop()
            if _isChanged(node, before):
                putPoints(node, before)
                return


def _isChanged(node: Any, before: list[PlacedPoint]) -> bool:
    return node.GetScene() is not None and placedPoints(node) != before


def whyNotRemoved(node: Any | None) -> str:
    """Return why no point of a node can be removed; empty if one can."""
    if node is None or not placedPoints(node):
        return _("No point is placed.")
    if node.GetLocked():
        return _("These points belong to the scenario; unlock the list in the module Markups.")
    return ""
