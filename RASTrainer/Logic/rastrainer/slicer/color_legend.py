"""A bar in the views that says which color is how many mm."""

from __future__ import annotations

from typing import Any

import slicer

CLASS_NAME = "vtkMRMLColorLegendDisplayNode"
LEFT, RIGHT = (0.05, 0.5), (0.95, 0.5)
"""Where in a view; the bars of two nodes must not cover each other."""


def showLegend(node: Any, title: str, place: tuple[float, float]) -> Any | None:
    """Show the legend of a colored `vtkMRMLDisplayableNode` and return it.

    None where the scene knows no legends: only Slicer's module Colors brings them.
    """
    if not node.GetScene().IsNodeClassRegistered(CLASS_NAME):
        return None
    legend = slicer.vtkSlicerColorLogic.AddDefaultColorLegendDisplayNode(node)
    legend.SetTitleText(title)
    legend.SetLabelFormat("%.1f")
    legend.SetPosition(*place)
    legend.SetVisibility(True)
    return legend


def hideLegend(node: Any) -> None:
    """Hide the legend of a node, if it has one."""
    legend = slicer.vtkSlicerColorLogic.GetColorLegendDisplayNode(node)
    if legend is not None:
        legend.SetVisibility(False)
