"""Brings a plot into view, where Slicer has views."""

from __future__ import annotations

from typing import Any

import slicer


def showChart(chart: Any) -> None:
    """Show a `vtkMRMLPlotChartNode` in a layout that has a plot view."""
    manager = slicer.app.layoutManager()
    if manager is None:
        return
    manager.setLayout(slicer.vtkMRMLLayoutNode.SlicerLayoutConventionalPlotView)
    logic = slicer.app.applicationLogic()
    logic.GetSelectionNode().SetActivePlotChartID(chart.GetID())
    logic.PropagatePlotChartSelection()
