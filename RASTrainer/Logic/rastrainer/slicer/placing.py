"""Slicer's mouse mode in which a click puts a point into a markup, and where slices jump to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

SELECTION = "vtkMRMLSelectionNodeSingleton"
INTERACTION = "vtkMRMLInteractionNodeSingleton"


def startPlacing(scene: Any, node: Any) -> bool:
    """Let the next clicks in the views place points of a markup; False where there are no views."""
    selection, interaction = scene.GetNodeByID(SELECTION), scene.GetNodeByID(INTERACTION)
    if selection is None or interaction is None:
        return False
    selection.SetReferenceActivePlaceNodeClassName(node.GetClassName())
    selection.SetActivePlaceNodeID(node.GetID())
    interaction.SetPlaceModePersistence(False)
    interaction.SetCurrentInteractionMode(interaction.Place)
    return True


def jumpTo(scene: Any, position: Sequence[float]) -> None:
    """Bring a place, (3,) float, RAS mm, into all slice views."""
    slices = scene.GetNodesByClass("vtkMRMLSliceNode")
    slices.UnRegister(None)
    for index in range(slices.GetNumberOfItems()):
        slices.GetItemAsObject(index).JumpSliceByCentering(*position)
