"""Pictures of Slicer's window."""

from __future__ import annotations

from typing import Any

import vtk
from PySide6 import QtCore, QtGui, QtWidgets

from Testing.slicer.host.layout import LayoutManager
from Testing.slicer.host.views import picture_of

GAP = 4


def window(panel: QtWidgets.QWidget, layout: LayoutManager) -> QtGui.QPixmap:
    """Return the panel next to the four views, which are as high as the panel, within reason."""
    height = min(max(panel.height() // 2, 240), 420)
    width = height * 4 // 3
    left = panel.width() + GAP
    total = QtCore.QSize(left + 2 * width + GAP, max(panel.height(), 2 * height + GAP))
    picture = QtGui.QPixmap(total)
    picture.fill(panel.palette().window().color())
    painter = QtGui.QPainter(picture)
    painter.drawPixmap(0, 0, panel.grab())
    right, lower = left + width + GAP, height + GAP
    red, green, yellow = layout.slice_views_of_host()
    pictures = {
        (left, 0): red.picture(width, height),
        (right, 0): layout.three_d_view_of_host().picture(width, height),
        (left, lower): green.picture(width, height),
        (right, lower): yellow.picture(width, height),
    }
    if layout.plotViewCount:
        chart = layout.plotWidget(0).mrmlPlotViewNode().GetPlotChartNode()
        if chart is not None:
            pictures[right, lower] = draw_chart(chart, width, height)
    for place, view in pictures.items():
        painter.drawImage(*place, view)
    painter.end()
    return picture


def draw_chart(node: Any, width: int, height: int) -> QtGui.QImage:
    """Return a picture of a `vtkMRMLPlotChartNode`."""
    view = vtk.vtkContextView()
    view.GetRenderer().SetBackground(1, 1, 1)
    window = view.GetRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(width, height)
    chart = vtk.vtkChartXY()
    view.GetScene().AddItem(chart)
    chart.SetTitle(node.GetTitle() or "")
    chart.SetShowLegend(node.GetLegendVisibility())
    for place, title, isAuto, span in (
        (vtk.vtkAxis.BOTTOM, node.GetXAxisTitle(), node.GetXAxisRangeAuto(), node.GetXAxisRange()),
        (vtk.vtkAxis.LEFT, node.GetYAxisTitle(), node.GetYAxisRangeAuto(), node.GetYAxisRange()),
    ):
        axis = chart.GetAxis(place)
        axis.SetTitle(title or "")
        if not isAuto:
            axis.SetBehavior(vtk.vtkAxis.FIXED)
            axis.SetRange(*span)
    for index in range(node.GetNumberOfPlotSeriesNodes()):
        _add_series(chart, node.GetNthPlotSeriesNode(index))
    view.Render()
    return picture_of(window, width, height)


def _add_series(chart: Any, series: Any) -> None:
    table = series.GetTableNode().GetTable() if series and series.GetTableNode() else None
    if table is None or table.GetNumberOfRows() < 1:
        return
    # As Slicer does, also for a series without a line: VTK logs an error where it has one point.
    isBar = series.GetPlotType() == series.PlotTypeScatterBar
    plot = chart.AddPlot(vtk.vtkChart.BAR if isBar else vtk.vtkChart.LINE)
    # A column by its name: VTK raises nothing for a missing one, and draws nothing.
    names = [table.GetColumnName(column) for column in range(table.GetNumberOfColumns())]
    horizontal, vertical = series.GetXColumnName(), series.GetYColumnName()
    if vertical not in names or (horizontal and horizontal not in names):
        chart.RemovePlotInstance(plot)
        return
    plot.SetInputData(table, horizontal or vertical, vertical)
    plot.SetUseIndexForXSeries(not horizontal)
    red, green, blue = series.GetColor()
    plot.SetColorF(red, green, blue, series.GetOpacity())
    plot.SetLabel(series.GetName())
    if not isBar:
        plot.SetMarkerStyle(series.GetMarkerStyle())
        plot.SetMarkerSize(series.GetMarkerSize())
        plot.GetPen().SetLineType(series.GetLineStyle())
        plot.SetWidth(series.GetLineWidth())
