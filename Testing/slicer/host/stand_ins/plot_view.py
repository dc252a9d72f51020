"""The plot view: draws the chart of a plot view node by VTK, without a screen."""

from __future__ import annotations

from typing import Any

import numpy as np
import vtk
from PySide6 import QtCore, QtGui, QtWidgets
from vtk.util.numpy_support import vtk_to_numpy

from Testing.slicer.host.stand_ins.observing import weakly


class qMRMLPlotView(QtWidgets.QLabel):
    """Shows the chart that its view node names, and follows the chart's changes."""

    mrmlSceneChanged = QtCore.Signal(object)

    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(parent)
        self._node: Any = None
        self._observed: list[tuple[Any, int]] = []
        self.setMinimumSize(120, 120)

    def setMRMLScene(self, scene: Any) -> None:
        self.mrmlSceneChanged.emit(scene)

    def mrmlPlotViewNode(self) -> Any:
        return self._node

    def setMRMLPlotViewNode(self, node: Any) -> None:
        self._node = node
        self._follow()

    def fitToContent(self) -> None:
        self._draw()

    def resizeEvent(self, event: QtGui.QResizeEvent) -> None:
        super().resizeEvent(event)
        self._draw()

    def sizeHint(self) -> QtCore.QSize:
        return QtCore.QSize(360, 240)

    def _chart_node(self) -> Any:
        return self._node.GetPlotChartNode() if self._node is not None else None

    def _follow(self, _event: str = "", _data: Any = None) -> None:
        for node, tag in self._observed:
            node.RemoveObserver(tag)
        chart = self._chart_node()
        self._observed = []
        for node, slot in ((self._node, self._follow), (chart, self._redraw)):
            if node is not None:
                tag = node.AddObserver(vtk.vtkCommand.ModifiedEvent, weakly(slot))
                self._observed.append((node, tag))
        self._draw()

    def _redraw(self, _event: str, _data: Any) -> None:
        self._draw()

    def _draw(self) -> None:
        chart = self._chart_node()
        if chart is None or not self.isVisible():
            self.clear()
            return
        self.setPixmap(QtGui.QPixmap.fromImage(draw_chart(chart, self.width(), self.height())))

    def showEvent(self, event: QtGui.QShowEvent) -> None:
        super().showEvent(event)
        self._draw()


class qMRMLPlotWidget(QtWidgets.QWidget):
    """A plot view with its controller, which is not shown here."""

    mrmlSceneChanged = QtCore.Signal(object)

    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(parent)
        self._view = qMRMLPlotView(self)
        column = QtWidgets.QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self._view)

    def plotView(self) -> qMRMLPlotView:
        return self._view

    def setMRMLScene(self, scene: Any) -> None:
        self._view.setMRMLScene(scene)
        self.mrmlSceneChanged.emit(scene)

    def mrmlPlotViewNode(self) -> Any:
        return self._view.mrmlPlotViewNode()

    def setMRMLPlotViewNode(self, node: Any) -> None:
        self._view.setMRMLPlotViewNode(node)


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
    reader = vtk.vtkWindowToImageFilter()
    reader.SetInput(window)
    reader.ReadFrontBufferOff()
    reader.Update()
    colors = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
    rows = np.ascontiguousarray(colors.reshape(height, width, -1)[::-1, :, :3])
    picture = QtGui.QImage(rows.data, width, height, 3 * width, QtGui.QImage.Format.Format_RGB888)
    return picture.copy()


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
