"""Pictures of Slicer's window."""

from __future__ import annotations

from PySide6 import QtCore, QtGui, QtWidgets

from Testing.slicer.host.layout import LayoutManager

GAP = 4


def window(panel: QtWidgets.QWidget, layout: LayoutManager, size: tuple) -> QtGui.QPixmap:
    """Return the panel beside the four views; `size` is that of one view, in pixels."""
    width, height = size
    left = panel.width() + GAP
    total = QtCore.QSize(left + 2 * width + GAP, max(panel.height(), 2 * height + GAP))
    picture = QtGui.QPixmap(total)
    picture.fill(panel.palette().window().color())
    painter = QtGui.QPainter(picture)
    painter.drawPixmap(0, 0, panel.grab())
    right, lower = left + width + GAP, height + GAP
    red, green, yellow = layout.slice_views_of_host()
    for view, place in (
        (red, (left, 0)),
        (layout.three_d_view_of_host(), (right, 0)),
        (green, (left, lower)),
        (yellow, (right, lower)),
    ):
        painter.drawImage(*place, view.picture(width, height))
    painter.end()
    return picture
