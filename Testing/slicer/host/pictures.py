"""Pictures of Slicer's window."""

from __future__ import annotations

from PySide6 import QtCore, QtGui, QtWidgets

from Testing.slicer.host.layout import LayoutManager
from Testing.slicer.host.stand_ins.plot_view import draw_chart

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
