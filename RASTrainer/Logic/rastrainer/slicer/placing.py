"""Slicer's mouse mode in which a click puts a point into a markup, and where slices jump to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

SELECTION = "vtkMRMLSelectionNodeSingleton"
INTERACTION = "vtkMRMLInteractionNodeSingleton"


def startPlacing(scene: Any, node: Any) -> None:
    """Let the next clicks in the views place points of a markup."""
    selection, interaction = scene.GetNodeByID(SELECTION), scene.GetNodeByID(INTERACTION)
    selection.SetReferenceActivePlaceNodeClassName(node.GetClassName())
    selection.SetActivePlaceNodeID(node.GetID())
    interaction.SetPlaceModePersistence(False)
    interaction.SetCurrentInteractionMode(interaction.Place)


def jumpTo(scene: Any, position: Sequence[float]) -> None:
    """Bring a place, (3,) float, RAS mm, into all slice views."""
    slices = scene.GetNodesByClass("vtkMRMLSliceNode")
    slices.UnRegister(None)
    for index in range(slices.GetNumberOfItems()):
        slices.GetItemAsObject(index).JumpSliceByCentering(*position)
