"""A small bar in the 3D view that says which color is how many mm; never more than one."""

from __future__ import annotations

from typing import Any

import slicer

CLASS_NAME = "vtkMRMLColorLegendDisplayNode"
RANK_ATTRIBUTE = "RASTrainer.legendRank"
"""On a legend of ours: which is shown where several are wanted; the highest, never 0."""
ARROWS_RANK, HEAD_RANK = 1, 2
SIZE = (0.1, 0.35)
"""Width and height as shares of the view."""
PLACE = (0.98, 0.5)


def showLegend(node: Any, title: str, rank: int) -> Any | None:
    """Show the legend of a colored `vtkMRMLDisplayableNode`, unless one of higher rank is shown.

    The slices stay free of it. Returns the legend, or None where the scene knows no legends: only
    Slicer's module Colors brings them.
    """
    if not node.GetScene().IsNodeClassRegistered(CLASS_NAME):
        return None
    legend = slicer.vtkSlicerColorLogic.GetColorLegendDisplayNode(node)
    if legend is None:
        legend = slicer.vtkSlicerColorLogic.AddDefaultColorLegendDisplayNode(node)
        legend.SetVisibility2D(False)
        legend.SetSize(*SIZE)
        legend.SetPosition(*PLACE)
        legend.SetLabelFormat("%.2f")
    legend.SetTitleText(title)
    legend.SetAttribute(RANK_ATTRIBUTE, str(rank))
    _showHighest(node.GetScene())
    return legend


def hideLegend(node: Any) -> None:
    """Hide the legend of a node, if it has one; another that is wanted takes its place."""
    legend = slicer.vtkSlicerColorLogic.GetColorLegendDisplayNode(node)
    if legend is not None:
        legend.SetAttribute(RANK_ATTRIBUTE, "0")
        _showHighest(node.GetScene())


def _showHighest(scene: Any) -> None:
    legends = scene.GetNodesByClass(CLASS_NAME)
    legends.UnRegister(None)
    found = [legends.GetItemAsObject(index) for index in range(legends.GetNumberOfItems())]
    ranks = {legend: int(legend.GetAttribute(RANK_ATTRIBUTE) or 0) for legend in found}
    # What has no rank is none of ours; a legend may have outlived what it belongs to.
    ours = [legend for legend in found if legend.GetAttribute(RANK_ATTRIBUTE) is not None]
    wanted = [legend for legend in ours if ranks[legend] and _isSeen(legend.GetDisplayableNode())]
    highest = max(wanted, key=ranks.get, default=None)
    for legend in ours:
        legend.SetVisibility(legend is highest)


def _isSeen(node: Any | None) -> bool:
    return node is not None and bool(node.GetDisplayVisibility())
