"""Slicer's mouse mode in which a click puts a point into a markup."""

from __future__ import annotations

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


def stopPlacing(scene: Any) -> None:
    """Let clicks in the views place nothing more; a point that only follows the mouse goes."""
    interaction = scene.GetNodeByID(INTERACTION)
    if interaction.GetCurrentInteractionMode() == interaction.Place:
        interaction.SetCurrentInteractionMode(interaction.ViewTransform)
