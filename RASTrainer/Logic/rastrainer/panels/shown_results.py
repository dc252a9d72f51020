"""Brings a plot or a table into view, where Slicer has views."""

from __future__ import annotations

from typing import Any

import slicer

from rastrainer.slicer.borrowed_layout import WITH_PLOT, WITH_TABLE, BorrowedLayout

CURVE, CALIBRATION, TABLES = "learning curve", "calibration", "tables"


def showChart(layout: BorrowedLayout, chart: Any, purpose: str = CURVE) -> None:
    """Show a `vtkMRMLPlotChartNode` in a layout that has a plot view."""
    layout.show(purpose, WITH_PLOT)
    logic = slicer.app.applicationLogic()
    logic.GetSelectionNode().SetActivePlotChartID(chart.GetID())
    logic.PropagatePlotChartSelection()


def showTable(layout: BorrowedLayout, table: Any) -> None:
    """Show a `vtkMRMLTableNode` in a layout that has a table view, where others can be chosen."""
    layout.show(TABLES, WITH_TABLE)
    logic = slicer.app.applicationLogic()
    logic.GetSelectionNode().SetActiveTableID(table.GetID())
    logic.PropagateTableSelection()
